"""Runs as the graph and other recorders make them: what they lack is named, and each timing counts as it was read."""

import dataclasses
import math

import numpy as np
import pytest

from kapitsa_ros.analysis.critical_speed import evidence_of
from kapitsa_ros.analysis.errors import AnalysisError, TableError
from kapitsa_ros.analysis.experiment import reduce_motions, reduce_runs
from kapitsa_ros.analysis.recorded_run import RecordedRun
from kapitsa_ros.analysis.table import Readings, refuse_mixed_units
from kapitsa_ros.analysis.timing_row import TimingRow, timing_rows
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.network.errors import RunError
from kapitsa_ros.network.run import Run
from kapitsa_ros.network.timing import Timing
from kapitsa_ros.operator.protocol import Protocol
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.units import RPM


@pytest.fixture(scope='module')
def runs(ideal_experiment: SimulatedExperiment) -> list[Run]:
    return ideal_experiment.runs()


@pytest.fixture(scope='module')
def ideal_experiment() -> SimulatedExperiment:
    speeds = (2240 * RPM, 2640 * RPM)
    return SimulatedExperiment(
        plant=Plant(), instruments=load_instruments('ideal'), protocol=Protocol(speeds=speeds), seed=1
    )


def test_settings_that_do_not_describe_an_instrument_are_named(runs: list[Run]) -> None:
    for broken in ({}, {'instrument': {}, 'seed': 1, 'extra': 0} | {'instrument': {'dial_end': -1.0}}):
        run = dataclasses.replace(runs[0], settings={**runs[0].settings, 'strobe': broken})
        with pytest.raises(RunError, match='run 1: its settings do not describe the strobe'):
            reduce_runs([run, runs[1]])


def test_runs_without_a_timing_have_no_critical_speed(runs: list[Run]) -> None:
    untimed = [dataclasses.replace(run, timings=()) for run in runs]
    assert reduce_runs(untimed).omega_crit is None


def timing(displayed: float, swings: int, **changed: object) -> Timing:
    values = {'time': 9.0, 'kind': 'timed', 'speed_asked': 2240 * RPM, 'speed_reading': 2240 * RPM, 'release': 0.12}
    return Timing(displayed=displayed, swings=swings, **{**values, **changed})


def test_timings_of_unlike_numbers_of_swings_are_fitted_with_one_period(runs: list[Run]) -> None:
    run = dataclasses.replace(runs[0], timings=(timing(2.0, 3), timing(4.0, 6)))
    assert run.period == pytest.approx(2.0 / 3.0)
    assert evidence_of(timing_rows([run])).timed.period == pytest.approx([2.0 / 3.0])


@pytest.mark.parametrize(
    ('useless', 'why'),
    [
        (timing(2.0, 3, speed_asked=None), 'the speed was changed while it lasted'),
        (timing(2.0, 3, speed_reading=None), 'no speed was read'),
        (timing(2.0, 3, speed_reading=math.nan), 'the speed read is none'),
        (timing(2.0, 3, speed_reading=-1.0), 'the speed read is none'),
        (timing(2.0, 0), 'no full swing was counted'),
        (timing(0.0, 3), 'the stopwatch showed no time'),
        (timing(math.nan, 3), 'the stopwatch showed no time'),
        (timing(0.0, 0, kind='fell', speed_asked=None), 'the speed was changed while it lasted'),
    ],
)
def test_a_timing_of_which_nothing_follows_is_listed_and_says_why(runs: list[Run], useless: Timing, why: str) -> None:
    with_it = dataclasses.replace(runs[0], timings=(*runs[0].timings, useless))
    found = reduce_runs([with_it, runs[1]])
    assert [row.unused for row in found.timings] == [None, why, None]
    assert dataclasses.replace(found, timings=()) == dataclasses.replace(reduce_runs(runs), timings=())


@pytest.mark.parametrize(
    ('angle', 'message'),
    [
        (np.array([]), 'no motion was recorded'),
        (np.zeros(5000), 'shows no swing'),
        (np.full(5000, 0.12), 'shows no swing'),
    ],
)
def test_a_record_that_shows_no_swing_is_said_to_show_none(runs: list[Run], angle: np.ndarray, message: str) -> None:
    time = np.arange(angle.size) / 1000.0
    with pytest.raises(AnalysisError, match=message):
        reduce_motions([RecordedRun(name='run_01', run=runs[0], time=time, angle=angle)])


def test_a_press_that_errs_by_most_of_a_swing_is_no_mix_up_of_units():
    """One swing of 0.4 s at 3000 RPM, of which a thumb that is 0.1 s out may show 0.095 s: 4.7 turns."""
    short = {'speed': 3000.0 * RPM, 'speed_sigma': 0.5, 'period': 0.095, 'period_sigma': 0.099, 'swings': 1}
    slow = {'speed': 1490.0 * RPM, 'speed_sigma': 0.5, 'period': 1.875, 'period_sigma': 0.099, 'swings': 1}
    rows = [TimingRow(kind='timed', release=0.12, run=number, **row) for number, row in enumerate((slow, short))]
    assert evidence_of(rows).timed.period.tolist() == [1.875, 0.095]
    with pytest.raises(TableError, match='give the speed in RPM'):
        refuse_mixed_units(Readings(np.array([37.0]), np.array([0.5]), np.zeros(1), np.array([0.03])))
