"""The numbers of the report."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from kapitsa_ros.analysis.assumptions import DEFAULT_ASSUMPTIONS
from kapitsa_ros.analysis.critical_speed import (
    errors_in_variables,
    fit_timings,
    ruler_of,
    uncertainty_budget,
)
from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.analysis.experiment import ideal_rod, plant_of, true_threshold
from kapitsa_ros.analysis.explain import explain
from kapitsa_ros.analysis.line_fit import fit_inverse_ols, fit_ols
from kapitsa_ros.analysis.plan import best_separation
from kapitsa_ros.analysis.timing_row import timing_rows
from kapitsa_ros.laboratory.campaign import perform_all, summarise
from kapitsa_ros.laboratory.preset_plans import plan_with_1997, shipped_plans
from kapitsa_ros.laboratory.preset_trials import shipped_outcomes, trial_experiment, trial_plants
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.averaged import omega_crit_averaged
from kapitsa_ros.physics.theory.play import omega_crit_with_play

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.analysis.critical_speed import Budget, CriticalSpeed, Evidence, Ruler
    from kapitsa_ros.analysis.explain import Ranking
    from kapitsa_ros.analysis.plan import Plan, Separation
    from kapitsa_ros.analysis.recorded_run import RecordedRun
    from kapitsa_ros.analysis.table import Readings
    from kapitsa_ros.analysis.timing_row import TimingRow
    from kapitsa_ros.laboratory.campaign import Campaign, Outcome

_Fit = TypeVar('_Fit')


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """One way to the critical speed, rad/s; None where it leads nowhere."""

    name: str
    value: float | None
    interval: tuple[float | None, float | None] | None = None
    of_1997: float | None = None
    discrepancy: float | None = 0.0
    """Relative error of the periods that was allowed for beyond the stated ones; None where none reconciles them."""


@dataclass(frozen=True, kw_only=True)
class Trial:
    """What the procedure of 1997 would have made of a plant."""

    name: str
    truth: float
    campaign: Campaign
    inverse_ols: tuple[float, float, float]
    """By the fit of 1997, rad/s: median, 16th and 84th percentile; nan where it gave none."""
    lines: int
    """Experiments in which it gave one."""
    plan: Plan | None
    """The cheapest protocol for the target, instead of that of 1997; None where there is none."""

    @property
    def half_width(self) -> float:
        """Half the median width of the intervals, over the truth."""
        return 0.5 * self.campaign.width / self.truth


@dataclass(frozen=True, kw_only=True, eq=False)
class Content:
    """All numbers of the report."""

    runs: tuple[RecordedRun, ...]
    plant: Plant
    ruler: Ruler
    assumptions: Assumptions
    curve: CriticalSpeed | None
    """The exact curve fitted to what was read; None where nothing was timed."""
    budget: Budget | None
    timings: tuple[TimingRow, ...]
    """What was read in these runs, with the repairs that the estimates rest on."""
    timed: Readings
    """Speeds and periods of what was timed."""
    of_1997: Readings
    estimates: tuple[Estimate, ...]
    predicted: float
    truth: float | None
    verdicts: tuple[tuple[str, Ranking], ...]
    trials: tuple[Trial, ...]
    beforehand: bool
    """Whether the experiments of the trials are those that are shipped."""
    plan: Plan | None
    separation: Separation


def gather(
    runs: Sequence[RecordedRun],
    of_1997: Readings,
    assumptions: Assumptions = DEFAULT_ASSUMPTIONS,
    experiments: int | None = None,
    on_progress: Callable[[str], None] = lambda _: None,
) -> Content:
    """Work out everything the report says, with the shipped experiments on each preset or as many new ones.

    Raises
    ------
    AnalysisError
        There are no runs, or they are of different plants.

    """
    blind = [recorded.run for recorded in runs]
    plant = plant_of(blind)
    nominal = ideal_rod(plant)
    ruler = ruler_of(*blind)
    on_progress('fitting the readings')
    found = fit_timings(timing_rows(blind, assumptions.dial_u), ruler, nominal.gravity, assumptions)
    evidence, curve = found.evidence, found.best
    has_budget = curve is not None and curve.discrepancy is not None
    budget = None if not has_budget else uncertainty_budget(evidence, ruler, nominal.gravity, assumptions)
    on_progress('trying causes')
    verdicts = [('the readings of 1997', explain(of_1997, Plant()))]
    if np.unique(evidence.timed.forcing).size > 1:
        verdicts.append(('the readings of these runs', explain(evidence.timed, nominal)))
    trials, shipped = [], shipped_outcomes() if experiments is None else {}
    plans = {} if experiments is not None else shipped_plans()
    for name, each in trial_plants().items():
        on_progress(f'virtual experiments: {name}')
        outcomes = shipped[name] if experiments is None else perform_all(trial_experiment(each), experiments)
        trials.append(_trial(name, each, list(outcomes), plans))
    on_progress('planning')
    return Content(
        runs=tuple(runs),
        plant=plant,
        ruler=ruler,
        assumptions=assumptions,
        curve=curve,
        budget=budget,
        timings=found.rows,
        timed=evidence.timed,
        of_1997=of_1997,
        estimates=_estimates(evidence, curve, of_1997),
        predicted=omega_crit_averaged(nominal),
        truth=true_threshold(plant),
        verdicts=tuple(verdicts),
        trials=tuple(trials),
        beforehand=experiments is None,
        plan=_plan(nominal, plans),
        separation=best_separation(of_1997, Plant(), 'inertia_factor', 'large_swing', ranking=verdicts[0][1]),
    )


def _estimates(evidence: Evidence, curve: CriticalSpeed | None, theirs: Readings) -> tuple[Estimate, ...]:
    """Fit lines and curve to the same rows."""
    line, line_1997 = _or_none(errors_in_variables, evidence.timed), errors_in_variables(theirs)
    backward, forward = _or_none(fit_inverse_ols, evidence.timed), _or_none(fit_ols, evidence.timed)
    return (
        Estimate(
            name='ω² on Ω², as in 1997',
            value=backward.omega_crit if backward else None,
            of_1997=fit_inverse_ols(theirs).omega_crit,
        ),
        Estimate(name='Ω² on ω²', value=forward.omega_crit if forward else None, of_1997=fit_ols(theirs).omega_crit),
        Estimate(
            name='line, uncertainty in both readings',
            value=line.omega_crit if line else None,
            interval=line.interval if line else None,
            of_1997=line_1997.omega_crit,
            discrepancy=line.discrepancy if line else 0.0,
        ),
        Estimate(
            name='exact curve with a ruler',
            value=curve.omega_crit if curve else None,
            interval=curve.interval if curve else None,
            discrepancy=curve.discrepancy if curve else 0.0,
        ),
    )


def _or_none(fit: Callable[[Readings], _Fit], readings: Readings) -> _Fit | None:
    try:
        return fit(readings)
    except TableError:
        return None  # one speed, or no rise


def _trial(name: str, plant: Plant, outcomes: Sequence[Outcome], plans: dict[Plant, Plan | None]) -> Trial:
    truth = omega_crit_with_play(plant)
    lines = [outcome.inverse_ols for outcome in outcomes if outcome.inverse_ols is not None]
    middle, low, high = np.quantile(lines, (0.5, 0.16, 0.84)).tolist() if lines else (np.nan,) * 3
    return Trial(
        name=name,
        truth=truth,
        campaign=summarise(outcomes, truth),
        inverse_ols=(middle, low, high),
        lines=len(lines),
        plan=_plan(plant, plans),
    )


def _plan(plant: Plant, known: dict[Plant, Plan | None]) -> Plan | None:
    if plant not in known:
        known[plant] = plan_with_1997(plant)
    return known[plant]
