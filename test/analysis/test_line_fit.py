from fractions import Fraction

import numpy as np
import pytest

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.analysis.line_fit import fit_inverse_ols, fit_ols, slope_ratio
from kapitsa_ros.analysis.table import Readings
from kapitsa_ros.analysis.timing_row import TimingRow
from kapitsa_ros.configuration.tables import load_table, read_table, read_timings, write_timings
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
        ('forcing_rpm,period_s,period_sigma_s\n2240,1,-1\n', 'standard uncertainty'),
        ('forcing_rpm,period_s\n37.3,1.0\n44,0.75\n', 'RPM'),
        ('forcing_rpm,period_s\n234,1.0\n276,0.75\n', 'RPM'),
        ('forcing_rpm,period_s\n2240,1000\n2640,750\n', 'milliseconds'),
        ('forcing_rpm,period_s\n2240,60\n2640,80\n', 'seconds'),
        ('forcing_rpm,period_s\n2240,1.0\n44,0.75\n', 'row 2: .*not Hz'),
        ('forcing_rpm,period_s,period_sigma_s\n2240,1.0,50\n', 'row 1: .*uncertainty of 50 s'),
        ('forcing_rpm,period_s\n2240,1,00\n2640,0,75\n', 'row 1 .*with a point'),
        ('forcing_rpm;period_s\n2240;1.0\n', 'by commas'),
        ('forcing_rpm,period_s,period_s\n2240,1.0,2.0\n', 'more than one column period_s'),
        ('forcing_rpm,period_s\n2240,1.0\n,\n2640,\n', "row 2: period_s is ''"),
        (
            'forcing_rpm,period_s,kind\n2240,1.0,timed\n1300,,stood\n',
            "row 2: kind is 'stood': write one",
        ),
        ('forcing_rpm,period_s,kind\n1300,1.0,fell\n', 'row 1: .* has no period_s'),
        ('forcing_rpm,period_s,swings\n2240,1.0,2.5\n', 'row 1: swings is 2.5: give a whole number'),
        ('forcing_rpm,period_s,alias\n2240,1.0,2/0\n', "row 1: alias is '2/0': write a ratio"),
        ('forcing_rpm,period_s,release_rad\n2240,1.0,seven\n', "row 1: release_rad is 'seven'"),
    ],
)
def test_tables_that_cannot_be_used_say_why(tmp_path, text, message):
    with pytest.raises(TableError, match=message):
        read_table(table(tmp_path, text))


@pytest.mark.parametrize(
    'text',
    [
        'forcing_rpm,period_s,,\n2240,1.00,,\n2640,0.75,,\n2780,0.68,,\n',
        'forcing_rpm,period_s\n2240,1.00\n,\n2640,0.75\n2780,0.68\n,\n,,,\n',
        ',forcing_rpm,,period_s\n,2240,,1.00\n,2640,,0.75\n,2780,,0.68\n',
    ],
)
def test_empty_cells_that_a_spreadsheet_leaves_are_not_there(tmp_path, of_1997, text):
    assert read_timings(table(tmp_path, text)).readings.period.tolist() == of_1997.period.tolist()


def test_a_column_that_is_not_read_is_named(tmp_path):
    read = read_timings(table(tmp_path, 'forcing_rpm,period_s,remark,forcing_sigma_RPM\n2240,1.0,windy,6\n'))
    [warning] = read.warnings
    assert 'not read: column remark, forcing_sigma_RPM' in warning


def test_what_is_written_is_read_back(tmp_path):
    rows = [
        TimingRow(
            kind='timed', speed=2640 * RPM, speed_sigma=5 * RPM, period=0.715, period_sigma=0.033,
            speed_asked=2640 * RPM, speed_reading=1760 * RPM, alias=Fraction(2, 3), release=-0.12, swings=3,
            displayed=2.14, time=7.1, run=2,
        ),
        TimingRow(kind='fell', speed=1340 * RPM, speed_sigma=5 * RPM, release=0.12, swings=0, run=3),
        TimingRow(kind='timed', speed=None, run=4, unused='no speed was read'),
    ]  # fmt: skip
    path = tmp_path / 'timings.csv'
    write_timings(path, rows)
    timed, fell = read_timings(path).rows
    assert [fell.kind, fell.period, fell.release, fell.swings, fell.run] == ['fell', None, 0.12, 0, 3]
    assert timed.speed == pytest.approx(2640 * RPM, rel=1e-15)
    assert timed.speed_reading == pytest.approx(1760 * RPM, rel=1e-15)
    exact = ('kind', 'period', 'period_sigma', 'alias', 'release', 'swings', 'displayed', 'time', 'run', 'unused')
    assert [getattr(timed, name) for name in exact] == [getattr(rows[0], name) for name in exact]
    assert '# left out: run 4, timed: no speed was read' in path.read_text()


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
