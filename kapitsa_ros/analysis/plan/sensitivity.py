"""What one run tells of the critical speed: the direct fit's period and its derivatives, and how long swings last."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.instruments.perfect_timing import swings_seen
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.theory.averaged import omega_crit_averaged, plant_of_threshold
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.physics.plant import Plant

_STEP = 1e-5  # relative, of the differences that stand for derivatives


@dataclass(frozen=True, kw_only=True)
class Sensitivity:
    """Period of the swing at one speed, and its logarithmic derivatives."""

    speed: float
    """ω, rad/s."""
    period: float
    """T, s."""
    of_threshold: float
    """d ln T / d ln of the averaged threshold, at constant λ."""
    of_amplitude: float
    """d ln T / d ln λ, at constant threshold."""
    of_speed: float
    """d ln T / dω, s/rad."""
    slowing: float
    """Share by which the released swing is slower than a small one."""
    swings: int
    """Full swings that can be timed before friction has eaten the motion."""

    def gradient(self, swings: int) -> NDArray[np.float64]:
        """Return d ln T by (ln threshold, ln λ, c): the swing narrows with c until its middle is timed."""
        waned = (0.75 + 0.5 * swings) * self.period
        return np.array([self.of_threshold, self.of_amplitude, -self.slowing * waned])


def sensitivity(plant: Plant, speed: float, release: float, most_swings: int) -> Sensitivity | None:
    """Work out what a run at one speed would tell.

    Returns
    -------
    Sensitivity or None
        None where the pendulum does not swing, falls, or stops within one swing.

    """
    try:
        seen = swings_seen(plant, speed, release, most_swings)
        small = slow_frequency_exact(plant, speed)
        slowing = 1.0 - slow_frequency_nonlinear(plant, speed, release) / small if small else 0.0
    except PhysicsError:
        return None
    if not small or seen < 1:
        return None
    threshold = omega_crit_averaged(plant)

    def log_period(threshold: float, amplitude: float, speed: float) -> float:
        rod = plant_of_threshold(threshold, amplitude, plant.gravity)
        return -math.log(slow_frequency_exact(rod, speed) or math.nan)

    def slope(parameter: int) -> float:
        up, down = [threshold, plant.amplitude, speed], [threshold, plant.amplitude, speed]
        up[parameter] *= 1.0 + _STEP
        down[parameter] *= 1.0 - _STEP
        return (log_period(*up) - log_period(*down)) / (2.0 * _STEP)

    return Sensitivity(
        speed=speed,
        period=2.0 * math.pi / (small * (1.0 - slowing)),
        of_threshold=slope(0),
        of_amplitude=slope(1),
        of_speed=slope(2) / speed,
        slowing=slowing,
        swings=seen,
    )
