"""Evidence from the recorded motion instead of the readings: what better instruments would have given."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.evidence import Bound, Evidence
from kapitsa_ros.analysis.slow_frequency import DEFAULT_ESTIMATOR, ESTIMATORS, softening
from kapitsa_ros.analysis.table import Readings
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.theory.averaged import k_of_slow_frequency

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.analysis.recorded_run import RecordedRun
    from kapitsa_ros.analysis.slow_frequency.estimate import SlowEstimate, SwingRecord
    from kapitsa_ros.physics.plant import Plant


_PASSES = 3
_FIRST = 20  # slow periods for the first estimate


def evidence_from_motion(runs: Sequence[RecordedRun], nominal: Plant, estimator: str = DEFAULT_ESTIMATOR) -> Evidence:
    """Estimate the slow frequency of each recorded swing, reduced to a small one; speeds are those asked.

    What friction does to a period is of second order in the decay a radian, γ/Ω, and hangs on its law: viscous friction
    lengthens it by half of (γ/Ω)², Coulomb friction under dither by about all of it. As the law is not known, (γ/Ω)²
    is taken for a standard uncertainty.

    Parameters
    ----------
    runs
        Of one plant.
    nominal
        The rod as it should be. How much a wide swing is slower is that of a rod of its stroke which swings as seen.
    estimator
        Name in `ESTIMATORS`.

    Raises
    ------
    AnalysisError
        There are no runs, none shows a swing, or one is too short for the estimator.

    """
    rows: list[tuple[float, float, float]] = []
    fell: list[Bound] = []
    for recorded in runs:
        run = recorded.run
        if recorded.changes_speed() or any(timing.speed_asked != run.speed_asked for timing in run.timings):
            raise AnalysisError(
                f'{recorded.name}: the speed was changed in this run, its motion is of no single one: analyse readings'
            )
        if run.fell:
            fell.append(Bound(speed=run.speed_asked, sigma=0.0, release=abs(run.release or 0.0)))
            continue
        record = recorded.living_swing()
        release = abs(run.release or 0.0) or float(np.abs(record.angle).max())
        try:
            slow = _small_swing(record, release, nominal, estimator)
        except (AnalysisError, PhysicsError) as error:
            raise AnalysisError(f'{recorded.name}: {error}') from error
        if not math.isfinite(slow.sigma):
            raise AnalysisError(
                f'{recorded.name}: too short a swing for {estimator} to know its error: take another estimator'
            )
        period = 2.0 * math.pi / slow.value
        friction = (slow.decay / slow.value) ** 2
        rows.append((run.speed_asked, period, period * math.hypot(slow.sigma / slow.value, friction)))
    if not rows:
        raise AnalysisError('no run shows a swing: give one that stayed up')
    forcing, period_column, sigma = np.array(rows, dtype=np.float64).T
    return Evidence(
        timed=Readings(forcing, period_column, np.zeros_like(forcing), sigma),
        release=np.zeros_like(forcing),
        swings=np.ones_like(forcing),
        fell=tuple(fell),
    )


def _small_swing(record: SwingRecord, release: float, nominal: Plant, estimator: str) -> SlowEstimate:
    """Estimate the frequency of a small swing: softening follows from a rod, and the rod from the frequency."""
    # In a long record a swing changes its frequency as it decays: no single one fits it without the softening.
    slow = ESTIMATORS[estimator](record.beginning(_FIRST), 0.0)
    for _ in range(_PASSES):
        k = k_of_slow_frequency(record.forcing, slow.value, nominal.amplitude, nominal.gravity)
        rod = replace(nominal, inertia_factor=nominal.inertia_factor * k / nominal.k)
        slow = ESTIMATORS[estimator](record, softening(rod, record.forcing, release))
    return slow
