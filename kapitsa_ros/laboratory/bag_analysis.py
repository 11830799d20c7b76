"""Recorded runs without the graph."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from kapitsa_ros import __version__
from kapitsa_ros.analysis.assumptions import DEFAULT_ASSUMPTIONS
from kapitsa_ros.analysis.experiment import budget_of, reduce_motions, reduce_runs
from kapitsa_ros.analysis.results import budget_values, experiment_values, motion_values, run_values
from kapitsa_ros.analysis.slow_frequency import DEFAULT_ESTIMATOR
from kapitsa_ros.recording.reader import RunBag, runs_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.network.run import Run


def analyse_bags(
    paths: Sequence[Path], assumptions: Assumptions = DEFAULT_ASSUMPTIONS, *, with_budget: bool = False
) -> dict[str, Any]:
    """Analyse recorded runs from their readings.

    Raises
    ------
    BagError
        A path is no run.
    RunError
        The runs do not belong together.

    """
    bags = runs_of(paths)
    runs = [recorded_values(bag) | run_values(bag.run) for bag in bags]
    found = reduce_runs([bag.run for bag in bags], assumptions)
    values = {'runs': runs} | experiment_values(found) | origin([bag.run for bag in bags])
    if with_budget:
        values['budget'] = budget_values(budget_of([bag.run for bag in bags], assumptions))
    return values


def analyse_motions(
    paths: Sequence[Path], estimator: str = DEFAULT_ESTIMATOR, assumptions: Assumptions = DEFAULT_ASSUMPTIONS
) -> dict[str, Any]:
    """Analyse recorded runs from the motion of the pendulum: what better instruments would have given.

    Parameters
    ----------
    paths
        Folders of the runs.
    estimator
        Of the slow frequency: a name in `ESTIMATORS`.
    assumptions
        On rod and instruments.

    Raises
    ------
    BagError
        A path is no run.
    AnalysisError
        The runs do not belong together, or one shows no swing.

    """
    bags = runs_of(paths)
    experiment, found = reduce_motions([bag.recorded for bag in bags], estimator, assumptions)
    periods = iter(found.period)
    runs = []
    for bag in bags:
        period = None if bag.run.fell else float(next(periods))
        runs.append(recorded_values(bag) | motion_values(bag.run, period))
    return {'runs': runs} | experiment_values(experiment) | origin([bag.run for bag in bags])


def origin(runs: Sequence[Run]) -> dict[str, Any]:
    """Return what runs were made with: plant, instruments and seed, as recorded, and this version of the package.

    A bag does not tell the protocol; instruments and seed are None where the runs have not the same.
    """
    instruments = [{name: run.settings[name].get('instrument') for name in ('strobe', 'stopwatch')} for run in runs]
    seeds = [run.settings['strobe'].get('seed') for run in runs]
    return {
        'plant': asdict(runs[0].plant),
        'instruments': _common(instruments),
        'protocol': None,
        'seed': _common(seeds),
        'version': __version__,
    }


def _common(values: Sequence[Any]) -> Any:
    return values[0] if all(value == values[0] for value in values) else None


def recorded_values(bag: RunBag) -> dict[str, Any]:
    """Return the values of a bag besides its readings."""
    samples, gaps = bag.motion_counts
    return {
        'bag': str(bag.path),
        'run': bag.number,
        'samples': samples,
        'gaps': gaps,
        'digest_ok': bag.integrity.ok,
        'defects': list(bag.defects),
    }
