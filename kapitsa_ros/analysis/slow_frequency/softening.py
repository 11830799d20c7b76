"""A wider swing is a slower one: from the frequency at the amplitude swung to that of a small swing."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.slow_frequency.estimate import SlowEstimate
from kapitsa_ros.analysis.slow_frequency.matrix_pencil import strongest_pole
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear

if TYPE_CHECKING:
    from kapitsa_ros.analysis.slow_frequency.estimate import SwingRecord
    from kapitsa_ros.physics.plant import Plant


_NEXT_ORDER = 0.2
_OF_ROD = 0.005
_WIDEST = 0.5


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
        θ at rest, rad.

    Raises
    ------
    PhysicsError
        No swing about upright belongs to it.

    """
    small = slow_frequency_exact(plant, speed)
    wide = slow_frequency_nonlinear(plant, speed, release)
    amplitude = release / (1.0 - plant.k * plant.amplitude)
    return (1.0 - wide / small) / amplitude**2 if small else 0.0


def of_small_swing(record: SwingRecord, value: float, sigma: float, softening: float) -> SlowEstimate:
    """Reduce a frequency found without regard to the amplitude, in rad/s as its error; add the decay of the swing.

    For A² stands twice the mean square of the drive-nulled motion, which is the mean of A² over whole periods.

    Raises
    ------
    AnalysisError
        It is too wide for that.

    """
    times, means = record.drive_nulled()
    slowing = 2.0 * softening * float(np.mean(means**2))
    refuse_wide(slowing)
    factor = 1.0 / (1.0 - slowing)
    decay = -strongest_pole(means, times[1] - times[0]).real
    return SlowEstimate(
        value=value * factor, sigma=math.hypot(sigma * factor, value * factor * softening_error(slowing)), decay=decay
    )


def softening_error(slowing: float) -> float:
    """Return the relative standard uncertainty of a frequency whose swing was slower than a small one by this share.

    The next order in A² is left out, and the amplitude is known to that order: up to a fifth of the slowing squared,
    for swings of 0.25 to 0.7 rad from 1.25 times the threshold on. The rod that the softening is of is known by the
    averaged equation: that leaves half a per cent of it open.
    """
    return slowing * math.hypot(_NEXT_ORDER * slowing, _OF_ROD)


def refuse_wide(slowing: float) -> None:
    """Refuse a swing that is slower than a small one by so large a share that this cannot be undone.

    Raises
    ------
    AnalysisError
        The share is beyond a half.

    """
    if slowing > _WIDEST:
        raise AnalysisError(
            f'the swing is slower by {100.0 * slowing:.0f} % than a small one, and cannot be reduced to it: '
            'let go from a smaller angle'
        )
