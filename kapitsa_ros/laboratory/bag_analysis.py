"""Recorded runs without the graph."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.analysis.experiment import reduce_motions, reduce_runs
from kapitsa_ros.analysis.results import experiment_values, run_values
from kapitsa_ros.analysis.slow_frequency import DEFAULT_ESTIMATOR
from kapitsa_ros.recording.reader import RunBag

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


def analyse_bags(paths: Sequence[Path]) -> dict[str, Any]:
    """Analyse recorded runs from their readings.

    Raises
    ------
    BagError
        A path is no run.
    RunError
        The runs do not belong together.

    """
    bags = [RunBag(path) for path in paths]
    runs = [recorded_values(bag) | run_values(bag.run) for bag in bags]
    return {'runs': runs} | experiment_values(reduce_runs([bag.run for bag in bags]))


def analyse_motions(paths: Sequence[Path], estimator: str = DEFAULT_ESTIMATOR) -> dict[str, Any]:
    """Analyse recorded runs from the motion of the pendulum: what better instruments would have given.

    Parameters
    ----------
    paths
        Folders of the runs.
    estimator
        Of the slow frequency: a name in `ESTIMATORS`.

    Raises
    ------
    BagError
        A path is no run.
    AnalysisError
        The runs do not belong together, or one shows no swing.

    """
    bags = [RunBag(path) for path in paths]
    experiment, found = reduce_motions([bag.recorded for bag in bags], estimator)
    periods = iter(found.period)
    runs = []
    for bag in bags:
        period = None if bag.run.fell else float(next(periods))
        runs.append(
            recorded_values(bag)
            | run_values(bag.run)
            | {'period_s': period, 'slow_rpm': None if period is None else 60.0 / period}
        )
    return {'runs': runs} | experiment_values(experiment)


def recorded_values(bag: RunBag) -> dict[str, Any]:
    """Return the values of a bag besides its readings."""
    return {'bag': str(bag.path), 'samples': int(bag.motion.angle.size), 'gaps': bag.motion.gaps}
