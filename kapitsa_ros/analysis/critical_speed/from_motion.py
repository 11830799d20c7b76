"""Evidence from the recorded motion instead of the readings: what better instruments would have given."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.critical_speed.evidence import Bound, Evidence
from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.slow_frequency.sinusoid_fit import sinusoid_fit_frequency
from kapitsa_ros.analysis.table import Readings
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.analysis.recorded_run import RecordedRun
    from kapitsa_ros.physics.plant import Plant


def evidence_from_motion(runs: Sequence[RecordedRun], nominal: Plant) -> Evidence:
    """Fit the slow frequency of each recorded swing, reduced to a small one; speeds are those asked.

    What friction does to a period is of second order in the decay a radian, γ/Ω, and hangs on its law: viscous friction
    lengthens it by half of (γ/Ω)², Coulomb friction under dither by about all of it. As the law is not known, (γ/Ω)²
    is taken for a standard error.

    Parameters
    ----------
    runs
        Of one plant.
    nominal
        The rod as it should be: says how much a wide swing is slower.

    Raises
    ------
    AnalysisError
        There are no runs, or none shows a swing.

    """
    rows: list[tuple[float, float, float]] = []
    fell: list[Bound] = []
    for recorded in runs:
        run = recorded.run
        if run.fell:
            fell.append(Bound(speed=run.speed_asked, sigma=0.0, release=abs(run.release or 0.0)))
            continue
        softening = _softening(nominal, run.speed_asked, abs(run.release or 0.0))
        slow = sinusoid_fit_frequency(recorded.living_swing(), softening)
        period = 2.0 * math.pi / slow.value
        friction = (slow.decay / slow.value) ** 2
        rows.append((run.speed_asked, period, period * math.hypot(slow.sigma / slow.value, friction)))
    if not rows:
        raise AnalysisError('no run shows a swing: give one that stayed up')
    forcing, period_column, sigma = np.array(rows, dtype=np.float64).T
    return Evidence(
        timed=Readings(forcing, period_column, np.zeros_like(forcing), sigma),
        release=np.zeros_like(forcing),
        fell=tuple(fell),
    )


def _softening(plant: Plant, speed: float, release: float) -> float:
    """Return s of Ω(A) = Ω(0)·(1 − s A²) that the nonlinear map has at this release.

    Let go at the bottom of the stroke, the slow swing is wider than the release by 1/(1 − kλ) (report, eq. 12).
    """
    try:
        small = slow_frequency_exact(plant, speed)
        wide = slow_frequency_nonlinear(plant, speed, release)
    except PhysicsError:
        return 0.0
    amplitude = release / (1.0 - plant.k * plant.amplitude)
    return (1.0 - wide / small) / amplitude**2 if small else 0.0
