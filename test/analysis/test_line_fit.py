import numpy as np
import pytest

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.analysis.line_fit import fit_inverse_ols, fit_ols, slope_ratio
from kapitsa_ros.analysis.table import Readings
from kapitsa_ros.configuration.tables import load_table, read_table
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.units import RPM


@pytest.fixture
def of_1997():
    return load_table('1997')


def table(tmp_path, text):
    path = tmp_path / 'table.csv'
    path.write_text(text)
    return path


def readings(forcing_rpm, period):
    forcing, period = np.array(forcing_rpm, float) * RPM, np.array(period, float)
    return Readings(forcing, period, np.zeros_like(forcing), np.full_like(period, 0.05))


def test_table_3_of_1997(of_1997):
    assert fit_ols(of_1997).omega_crit / RPM == pytest.approx(1636.2478343616735, rel=1e-12)
    assert fit_inverse_ols(of_1997).omega_crit / RPM == pytest.approx(1639.9930403128913, rel=1e-12)
    assert slope_ratio(fit_ols(of_1997), Plant()) == pytest.approx(0.5145201140312049, rel=1e-12)


def test_printed_slow_speeds_give_another_figure():
    rounded = readings([2240, 2640, 2780], [60 / 60, 60 / 80, 60 / 88])
    assert fit_ols(rounded).omega_crit / RPM == pytest.approx(1629.3673457477657, rel=1e-12)


def test_exact_line_is_given_back_both_ways():
    forcing, omega_crit, slope = np.array([1800.0, 2300.0, 2900.0]), 1354.8, 0.0029
    slow = np.sqrt(slope * (forcing**2 - omega_crit**2))
    for fit in (fit_ols, fit_inverse_ols):
        line = fit(readings(forcing, 60 / slow))
        assert (line.omega_crit / RPM, line.slope) == pytest.approx((omega_crit, slope), rel=1e-10)


def test_errors_default_and_are_read(tmp_path):
    plain = read_table(table(tmp_path, 'forcing_rpm,period_s\n2240,1.0\n2640,0.75\n'))
    assert plain.forcing_sigma.tolist() == [0, 0]
    assert plain.period_sigma.tolist() == [0.05, 0.05]
    text = '# ours\n period_s ,forcing_rpm,period_sigma_s,forcing_sigma_rpm\n1.0,2240,0.02,6\n0.75,2640,,\n'
    full = read_table(table(tmp_path, text))
    assert full.period_sigma.tolist() == [0.02, 0.05]
    assert full.forcing_sigma / RPM == pytest.approx([6, 0])


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        ('', 'no column forcing_rpm, period_s'),
        ('forcing_rpm\n2240\n', 'no column period_s'),
        ('forcing_rpm,period_s\n2240,soon\n', "row 1: period_s is 'soon'"),
        ('forcing_rpm,period_s\n2240,1.0\n2640\n', "row 2: period_s is ''"),
        ('forcing_rpm,period_s\n2240,0\n2640,0.75\n', 'zero or negative'),
        ('forcing_rpm,period_s\n-2240,1\n2640,0.75\n', 'zero or negative'),
        ('forcing_rpm,period_s\n2240,nan\n2640,0.75\n', 'not finite'),
        ('forcing_rpm,period_s,period_sigma_s\n2240,1,-1\n', 'standard error'),
        ('forcing_rpm,period_s\n37.3,1.0\n44,0.75\n', 'RPM'),
        ('forcing_rpm,period_s\n234,1.0\n276,0.75\n', 'RPM'),
        ('forcing_rpm,period_s\n2240,1000\n2640,750\n', 'milliseconds'),
        ('forcing_rpm,period_s\n2240,60\n2640,80\n', 'seconds'),
        ('forcing_rpm,period_s\n2240,1.0\n44,0.75\n', 'row 2: .*not Hz'),
        ('forcing_rpm,period_s,period_sigma_s\n2240,1.0,50\n', 'row 1: .*error of 50 s'),
        ('forcing_rpm,period_s\n2240,1,00\n2640,0,75\n', 'row 1 .*with a point'),
        ('forcing_rpm;period_s\n2240;1.0\n', 'by commas'),
        ('forcing_rpm,period_s,period_s\n2240,1.0,2.0\n', 'more than one column period_s'),
    ],
)
def test_tables_that_cannot_be_used_say_why(tmp_path, text, message):
    with pytest.raises(TableError, match=message):
        read_table(table(tmp_path, text))


def test_file_that_is_not_there(tmp_path):
    with pytest.raises(TableError, match='cannot be read'):
        read_table(tmp_path / 'none.csv')


@pytest.mark.parametrize(
    ('rpm', 'period', 'message'),
    [
        ([2240], [1.0], 'two speeds'),
        ([2240, 2240, 2240], [1.0, 0.9, 1.1], 'equal'),
        ([2240, 2640], [0.7, 0.9], 'contradict'),
        ([2240, 2640], [0.7, 0.7], 'contradict'),
    ],
)
def test_runs_without_a_line_say_why(rpm, period, message):
    for fit in (fit_ols, fit_inverse_ols):
        with pytest.raises(TableError, match=message):
            fit(readings(rpm, period))


def test_line_that_meets_no_real_speed_has_no_critical_one():
    steep = readings([2000, 2100], [1.0, 0.99])
    assert fit_ols(steep).omega_crit is None
    assert fit_inverse_ols(steep).omega_crit is None
