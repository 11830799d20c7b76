"""From the runs of an experiment to its critical speed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kapitsa_ros.analysis.assumptions import DEFAULT_ASSUMPTIONS
from kapitsa_ros.analysis.critical_speed import (
    direct_fit,
    evidence_from_motion,
    fit_timings,
    ruler_of,
    uncertainty_budget,
)
from kapitsa_ros.analysis.errors import NothingTimedError, TableError
from kapitsa_ros.analysis.line_fit import fit_inverse_ols, fit_ols
from kapitsa_ros.analysis.slow_frequency import DEFAULT_ESTIMATOR
from kapitsa_ros.analysis.timing_row import timing_rows
from kapitsa_ros.network.errors import RunError
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.theory.averaged import omega_crit_averaged
from kapitsa_ros.physics.theory.play import omega_crit_with_play

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.analysis.critical_speed import Budget, CriticalSpeed, Evidence, Ruler
    from kapitsa_ros.analysis.line_fit import LineFit
    from kapitsa_ros.analysis.recorded_run import RecordedRun
    from kapitsa_ros.analysis.table import Readings
    from kapitsa_ros.analysis.timing_row import TimingRow
    from kapitsa_ros.network.run import Run
    from kapitsa_ros.physics.plant import Plant


@dataclass(frozen=True, kw_only=True)
class Experiment:
    """What several runs together say of the critical speed; speeds in rad/s, None where there is no value."""

    omega_crit: float | None
    """The best estimate: the exact curve fitted to all that was read."""
    interval: tuple[float | None, float | None] | None
    """95 % interval of `omega_crit`; an end that is None is unbounded."""
    assumptions: Assumptions
    """What was taken for granted."""
    ruler: Ruler
    """What the ruler said of the stroke."""
    timings: tuple[TimingRow, ...]
    """Each timing and fall, as read and as taken; none where the motion was analysed instead."""
    discrepancy: float | None
    """Relative error of the periods beyond the stated ones that makes the runs agree (see `direct_fit`)."""
    play_probability: float | None
    """That the pivot has play, by these readings."""
    heavy_damping_probability: float | None
    """That damping is not light, by these readings."""
    effective_rods: float | None
    """How many rods of its sample the interval rests on."""
    inverse_ols: float | None
    ols: float | None
    predicted: float
    """By averaged theory for an ideal rod of this length and stroke (report, eq. 8)."""
    truth: float | None
    """Exact threshold of the plant that was simulated; None where there is none."""

    @property
    def error_percent(self) -> float | None:
        """Of `inverse_ols` against `predicted`, as Table 3 has it."""
        return _percent_off(self.inverse_ols, self.predicted)

    @property
    def deviation_percent(self) -> float | None:
        """Of `omega_crit` against `truth`."""
        return _percent_off(self.omega_crit, self.truth)


def reduce_runs(runs: Sequence[Run], assumptions: Assumptions = DEFAULT_ASSUMPTIONS) -> Experiment:
    """Reduce the readings of several runs of one plant as in 1997.

    Raises
    ------
    RunError
        There are no runs, or they are of different plants.

    """
    plant, ruler = plant_of(runs), ruler_of(*runs)
    found = fit_timings(timing_rows(runs, assumptions.dial_u), ruler, plant.gravity, assumptions)
    return _experiment(plant, found.best, found.evidence, ruler=ruler, timings=found.rows, assumptions=assumptions)


def budget_of(runs: Sequence[Run], assumptions: Assumptions = DEFAULT_ASSUMPTIONS) -> Budget:
    """Work out what the uncertainty of the critical speed is made of, from the readings of several runs of one plant.

    Raises
    ------
    RunError
        There are no runs, or they are of different plants.
    NothingTimedError
        No run was timed.

    """
    plant, ruler = plant_of(runs), ruler_of(*runs)
    found = fit_timings(timing_rows(runs, assumptions.dial_u), ruler, plant.gravity, assumptions)
    return uncertainty_budget(found.evidence, ruler, plant.gravity, assumptions)


def reduce_motions(
    recorded: Sequence[RecordedRun],
    estimator: str = DEFAULT_ESTIMATOR,
    assumptions: Assumptions = DEFAULT_ASSUMPTIONS,
) -> tuple[Experiment, Readings]:
    """Reduce what was recorded of the motion instead of what was read; also return the periods found there.

    Parameters
    ----------
    recorded
        Runs of one plant.
    estimator
        Of the slow frequency: a name in `ESTIMATORS`.
    assumptions
        On rod and instruments.

    Raises
    ------
    AnalysisError
        There are no runs, they are of different plants, or none shows a swing.

    """
    plant = plant_of([each.run for each in recorded])
    assumptions = replace(assumptions, miscount_probability=0.0)  # nobody counts
    evidence = evidence_from_motion(recorded, ideal_rod(plant), estimator)
    ruler = ruler_of(*(each.run for each in recorded))
    try:
        best = direct_fit(evidence, ruler, plant.gravity, assumptions)
    except NothingTimedError:
        best = None  # no run swung
    return _experiment(plant, best, evidence, ruler=ruler, timings=(), assumptions=assumptions), evidence.timed


def plant_of(runs: Sequence[Run]) -> Plant:
    """Return the plant of all runs.

    Raises
    ------
    RunError
        There are no runs, or they are of different plants.

    """
    if not runs:
        raise RunError('no runs: give one bag or more')
    plant = runs[0].plant
    if any(run.plant != plant for run in runs):
        raise RunError('the runs are of different plants: analyse each plant on its own')
    return plant


def ideal_rod(plant: Plant) -> Plant:
    """Return the rod the report's theory speaks of: same length, stroke and gravity, nothing else."""
    return type(plant)(length=plant.length, amplitude=plant.amplitude, gravity=plant.gravity)


def _experiment(
    plant: Plant,
    best: CriticalSpeed | None,
    evidence: Evidence,
    *,
    ruler: Ruler,
    timings: Sequence[TimingRow],
    assumptions: Assumptions,
) -> Experiment:
    return Experiment(
        omega_crit=None if best is None else best.omega_crit,
        interval=None if best is None else best.interval,
        discrepancy=None if best is None else best.discrepancy,
        play_probability=None if best is None else best.play_probability,
        heavy_damping_probability=None if best is None else best.heavy_damping_probability,
        effective_rods=None if best is None else best.effective_rods,
        assumptions=assumptions,
        ruler=ruler,
        timings=tuple(timings),
        inverse_ols=_fit(fit_inverse_ols, evidence.timed),
        ols=_fit(fit_ols, evidence.timed),
        predicted=omega_crit_averaged(ideal_rod(plant)),
        truth=true_threshold(plant),
    )


def true_threshold(plant: Plant) -> float | None:
    """Return the exact threshold of a plant that was simulated, rad/s; None where there is none."""
    try:
        return omega_crit_with_play(plant)
    except PhysicsError:
        return None


def _percent_off(value: float | None, reference: float | None) -> float | None:
    return None if value is None or reference is None else 100.0 * (value / reference - 1.0)


def _fit(fit: Callable[[Readings], LineFit], readings: Readings) -> float | None:
    try:
        return fit(readings).omega_crit
    except TableError:
        return None  # too few runs gave readings, or they show no rise: there is no value
