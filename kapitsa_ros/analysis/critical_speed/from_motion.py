"""Evidence from the recorded motion instead of the readings: what better instruments would have given."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.critical_speed.evidence import Bound, Evidence
from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.slow_frequency import DEFAULT_ESTIMATOR, ESTIMATORS, softening
from kapitsa_ros.analysis.table import Readings

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.analysis.recorded_run import RecordedRun
    from kapitsa_ros.physics.plant import Plant


def evidence_from_motion(runs: Sequence[RecordedRun], nominal: Plant, estimator: str = DEFAULT_ESTIMATOR) -> Evidence:
    """Estimate the slow frequency of each recorded swing, reduced to a small one; speeds are those asked.

    What friction does to a period is of second order in the decay a radian, γ/Ω, and hangs on its law: viscous friction
    lengthens it by half of (γ/Ω)², Coulomb friction under dither by about all of it. As the law is not known, (γ/Ω)²
    is taken for a standard error.

    Parameters
    ----------
    runs
        Of one plant.
    nominal
        The rod as it should be: says how much a wide swing is slower.
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
        if any(timing.speed_asked != run.speed_asked for timing in run.timings):
            raise AnalysisError(
                f'{recorded.name}: the speed was changed in this run, its motion is of no single one: analyse readings'
            )
        if run.fell:
            fell.append(Bound(speed=run.speed_asked, sigma=0.0, release=abs(run.release or 0.0)))
            continue
        soft = softening(nominal, run.speed_asked, abs(run.release or 0.0))
        slow = ESTIMATORS[estimator](recorded.living_swing(), soft)
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
