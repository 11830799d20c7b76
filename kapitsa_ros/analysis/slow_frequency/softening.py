"""A wider swing is a slower one: from the frequency at the amplitude swung to that of a small swing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.slow_frequency.estimate import SlowEstimate
from kapitsa_ros.analysis.slow_frequency.matrix_pencil import strongest_pole
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear

if TYPE_CHECKING:
    from kapitsa_ros.analysis.slow_frequency.estimate import SwingRecord
    from kapitsa_ros.physics.plant import Plant


def softening(plant: Plant, speed: float, release: float) -> float:
    """Return s of Ω(A) = Ω(0)·(1 − s A²) that the nonlinear map has at this release, 1/rad²; A is in rad.

    Let go at the bottom of the stroke, the slow swing is wider than the release by 1/(1 − kλ) (report, eq. 12).

    Parameters
    ----------
    plant
        Without losses.
    speed
        ω, rad/s.
    release
        θ at rest, rad. Where no swing about upright belongs to it, s is 0.

    """
    try:
        small = slow_frequency_exact(plant, speed)
        wide = slow_frequency_nonlinear(plant, speed, release)
    except PhysicsError:
        return 0.0
    amplitude = release / (1.0 - plant.k * plant.amplitude)
    return (1.0 - wide / small) / amplitude**2 if small else 0.0


def of_small_swing(record: SwingRecord, value: float, sigma: float, softening: float) -> SlowEstimate:
    """Reduce a frequency found without regard to the amplitude, in rad/s as its error; add the decay of the swing.

    For A² stands twice the mean square of the drive-nulled motion, which is the mean of A² over whole periods.

    Raises
    ------
    AnalysisError
        By this softening no such swing could be.

    """
    times, means = record.drive_nulled()
    slowing = 2.0 * softening * float(np.mean(means**2))
    if slowing >= 1.0:
        raise AnalysisError('the swing is too wide to be reduced to a small one: take another estimator')
    factor = 1.0 / (1.0 - slowing)
    decay = -strongest_pole(means, times[1] - times[0]).real
    return SlowEstimate(value=value * factor, sigma=sigma * factor, decay=decay)
