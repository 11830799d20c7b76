"""The numbers of the report."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kapitsa_ros.analysis.campaign import Cores, perform_all, summarise
from kapitsa_ros.analysis.critical import Ruler, direct_fit, errors_in_variables, evidence_of, true_threshold
from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.explain import explain
from kapitsa_ros.analysis.plan import best_separation, cheapest_plan
from kapitsa_ros.analysis.reduction import inverse, ordinary
from kapitsa_ros.analysis.virtual import VirtualExperiment
from kapitsa_ros.instruments.protocol import load_protocol
from kapitsa_ros.instruments.settings import load_instruments
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.parameters import PRESETS, PlantParameters, load_preset
from kapitsa_ros.physics.theory.averaged import omega_crit_averaged

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.analysis.campaign import Campaign
    from kapitsa_ros.analysis.critical import Evidence
    from kapitsa_ros.analysis.explain import Verdict
    from kapitsa_ros.analysis.plan import Plan, Separation
    from kapitsa_ros.analysis.recorded import RecordedRun
    from kapitsa_ros.analysis.table import Readings

EXPERIMENTS = 40
"""Virtual experiments for each preset."""

TARGET_PERCENT = 1.0


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """One way to the critical speed, rad/s; None where it leads nowhere."""

    name: str
    value: float | None
    interval: tuple[float | None, float | None] | None = None
    of_1997: float | None = None


@dataclass(frozen=True, kw_only=True)
class PresetTrial:
    """What the procedure of 1997 would have made of a plant."""

    preset: str
    truth: float
    campaign: Campaign


@dataclass(frozen=True, kw_only=True, eq=False)
class Content:
    """All numbers of the report."""

    runs: tuple[RecordedRun, ...]
    plant: PlantParameters
    of_1997: Readings
    estimates: tuple[Estimate, ...]
    predicted: float
    truth: float | None
    verdicts: tuple[tuple[str, Verdict], ...]
    trials: tuple[PresetTrial, ...]
    plan: Plan | None
    separation: Separation


def gather(runs: Sequence[RecordedRun], of_1997: Readings, experiments: int = EXPERIMENTS) -> Content:
    """Work out everything the report says, with `experiments` virtual ones for each preset.

    Raises
    ------
    AnalysisError
        There are no runs, or too few of them were timed.

    """
    if not runs:
        raise AnalysisError('no runs: give one bag or more')
    plant = runs[0].run.plant
    evidence = evidence_of([recorded.run for recorded in runs])
    nominal = PlantParameters(length=plant.length, amplitude=plant.amplitude, gravity=plant.gravity)
    return Content(
        runs=tuple(runs),
        plant=plant,
        of_1997=of_1997,
        estimates=_estimates(evidence, nominal, of_1997),
        predicted=omega_crit_averaged(nominal),
        truth=_truth(plant),
        verdicts=(
            ('the readings of 1997', explain(of_1997, PlantParameters())),
            ('the readings of these runs', explain(evidence.timed, nominal)),
        ),
        trials=tuple(_trial(preset, experiments) for preset in PRESETS),
        plan=_plan(nominal),
        separation=best_separation(of_1997, PlantParameters(), 'inertia_factor', 'large_swing'),
    )


def _estimates(evidence: Evidence, nominal: PlantParameters, theirs: Readings) -> tuple[Estimate, ...]:
    ours = evidence.timed
    line, line_1997 = errors_in_variables(ours), errors_in_variables(theirs)
    curve = direct_fit(evidence, Ruler(amplitude=nominal.amplitude), nominal.gravity)
    return (
        Estimate(name='ω² on Ω², as in 1997', value=inverse(ours).omega_crit, of_1997=inverse(theirs).omega_crit),
        Estimate(name='Ω² on ω²', value=ordinary(ours).omega_crit, of_1997=ordinary(theirs).omega_crit),
        Estimate(
            name='line, errors in both readings',
            value=line.omega_crit,
            interval=line.interval,
            of_1997=line_1997.omega_crit,
        ),
        Estimate(name='exact curve with a ruler', value=curve.omega_crit, interval=curve.interval),
    )


def _truth(plant: PlantParameters) -> float | None:
    try:
        return true_threshold(plant)
    except PhysicsError:
        return None


def _trial(preset: str, experiments: int) -> PresetTrial:
    plant = load_preset(preset)
    experiment = VirtualExperiment(
        plant=plant, instruments=load_instruments('1997'), protocol=load_protocol('1997'), seed=0
    )
    truth = true_threshold(plant)
    campaign = summarise(list(perform_all(experiment, experiments)), truth, 1.0, Cores.count)
    return PresetTrial(preset=preset, truth=truth, campaign=campaign)


def _plan(plant: PlantParameters) -> Plan | None:
    try:
        return cheapest_plan(plant, load_instruments('1997'), TARGET_PERCENT)
    except AnalysisError:
        return None
