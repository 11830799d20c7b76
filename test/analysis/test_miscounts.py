"""Swings that were counted one wrong are found by what the other readings say."""

from dataclasses import replace

import numpy as np
import pytest

import kapitsa_ros as kr
from kapitsa_ros.analysis.assumptions import Assumptions
from kapitsa_ros.analysis.critical_speed import Ruler, fit_timings
from kapitsa_ros.analysis.experiment import reduce_runs
from kapitsa_ros.analysis.results import experiment_values
from kapitsa_ros.analysis.timing_row import TimingRow, timing_rows
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.floquet import omega_crit_exact
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear
from kapitsa_ros.reporting.report_tables import repairs
from kapitsa_ros.units import RPM, is_within

ROD = Plant()
SPEEDS = np.array([1800.0, 2240.0, 2640.0, 2780.0]) * RPM
RULER = Ruler(amplitude=ROD.amplitude)
CAREFUL = Assumptions(miscount_probability=0.0)


def timing(speed, number, *, counted=3, passed=3, error=0.0):
    """Return what a person notes who counts so many swings while so many pass."""
    display = passed * 2.0 * np.pi / slow_frequency_nonlinear(ROD, speed, 0.12) + error
    return TimingRow(
        kind='timed',
        speed=float(speed),
        speed_sigma=2.0 * RPM,
        period=float(display / counted),
        period_sigma=0.05 / counted,
        release=0.12,
        swings=counted,
        displayed=float(display),
        run=number,
    )


def experiment(seed, miscount, speeds=SPEEDS):
    instruments = load_instruments('1997', {'miscount_probability': miscount})
    protocol = replace(load_protocol('1997'), speeds=tuple(speeds))
    return SimulatedExperiment(plant=ROD, instruments=instruments, protocol=protocol, seed=seed).runs()


@pytest.mark.parametrize('passed', [2, 4])
@pytest.mark.parametrize('wrong', range(4))
def test_a_count_that_is_one_wrong_is_found(wrong, passed):
    rows = [timing(speed, number, passed=passed if number == wrong else 3) for number, speed in enumerate(SPEEDS)]
    found = fit_timings(rows, RULER, ROD.gravity)
    assert [row.swings_taken for row in found.rows] == [passed if number == wrong else None for number in range(4)]
    assert found.rows[wrong].miscount_probability > 0.95
    assert found.rows[wrong].period == pytest.approx(rows[wrong].period * 3 / passed, rel=1e-12)
    assert found.best.omega_crit == pytest.approx(omega_crit_exact(ROD), rel=2e-3)
    assert is_within(omega_crit_exact(ROD), found.best.interval)


def test_a_miscount_that_is_repaired_gives_the_interval_of_a_right_count():
    right = fit_timings([timing(speed, number) for number, speed in enumerate(SPEEDS)], RULER, ROD.gravity)
    rows = [timing(speed, number, passed=4 if number == 3 else 3) for number, speed in enumerate(SPEEDS)]
    wrong = fit_timings(rows, RULER, ROD.gravity)
    width, repaired = (np.ptp(each.best.interval) for each in (right, wrong))
    assert repaired == pytest.approx(width, rel=0.05)


def test_right_counts_are_left_alone():
    rows = [timing(speed, number) for number, speed in enumerate(SPEEDS)]
    found, careful = (fit_timings(rows, RULER, ROD.gravity, each) for each in (Assumptions(), CAREFUL))
    assert all(row.swings_taken is None and row.miscount is None for row in found.rows)
    assert found.best.omega_crit == careful.best.omega_crit
    assert found.best.interval == pytest.approx(careful.best.interval, rel=1e-3)


def test_two_timings_of_a_run_that_disagree_by_a_swing_are_not_averaged():
    rows = [timing(speed, number) for number, speed in enumerate(SPEEDS)]
    rows.insert(2, timing(SPEEDS[1], 1, passed=2, error=0.02))
    found = fit_timings(rows, RULER, ROD.gravity)
    assert [row.swings_taken for row in found.rows] == [None, None, 2, None, None]
    assert found.best.omega_crit == pytest.approx(omega_crit_exact(ROD), rel=5e-3)


def test_who_never_miscounts_is_told_that_the_readings_disagree():
    rows = [timing(speed, number, passed=4 if number == 3 else 3) for number, speed in enumerate(SPEEDS)]
    found = fit_timings(rows, RULER, ROD.gravity, CAREFUL)
    assert all(row.swings_taken is None for row in found.rows)
    assert found.best.discrepancy != 0.0


@pytest.mark.parametrize('seed', range(1, 7))
def test_the_virtual_person_s_miscounts_are_found(seed):
    wrong, right = experiment(seed, 0.3), experiment(seed, 0.0)
    found = reduce_runs(wrong)
    passed = [
        round(row.swings * row.displayed / other.displayed)
        for row, other in zip(timing_rows(wrong), timing_rows(right), strict=True)
    ]
    likely = [row.swings_taken or row.swings for row in found.timings]
    sure = [min(row.miscount_probability, 1.0 - row.miscount_probability) < 0.01 for row in found.timings]
    assert [taken for taken, is_sure in zip(likely, sure, strict=True) if is_sure] == [
        true for true, is_sure in zip(passed, sure, strict=True) if is_sure
    ]
    assert is_within(found.truth, found.interval)


def test_a_miscount_is_said_in_tables_and_json():
    rows = [timing(speed, number, passed=4 if number == 3 else 3) for number, speed in enumerate(SPEEDS)]
    found = fit_timings(rows, RULER, ROD.gravity)
    said = 'run 3: 3 swings counted, taken as 4, by the other readings'
    assert found.rows[3].miscount == said
    uncounted = fit_timings([replace(row, swings=None) for row in rows], RULER, ROD.gravity)
    assert all(row.miscount_probability is None for row in uncounted.rows)
    values = experiment_values(reduce_runs(experiment(4, 0.3)))
    taken = [timing['miscount'] for timing in values['timings'] if timing['swings_taken']]
    assert taken
    assert set(taken) <= set(repairs(values))


def test_reduce_takes_the_same_counts_from_a_table(tmp_path):
    table = tmp_path / 'readings.csv'
    lines = ['forcing_rpm,period_s,period_sigma_s,swings,run']
    for number, speed in enumerate(SPEEDS):
        row = timing(speed, number, passed=4 if number == 3 else 3)
        lines.append(f'{speed / RPM:.1f},{row.period:.5f},0.0167,3,{number}')
    table.write_text('\n'.join(lines) + '\n', encoding='utf-8')
    found = kr.reduce(str(table))
    assert 'run 3: 3 swings counted, taken as 4, by the other readings' in found.warnings
    assert found.omega_crit == pytest.approx(omega_crit_exact(ROD), rel=5e-3)
