# ruff: noqa: PLR0917 (compiled functions take their arrays by position)
"""Störmer and Verlet's method, as a peer in the study of solvers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kapitsa_ros.physics.kernels.jit import kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@kernel
def verlet(
    weight: float,
    drive: float,
    speed: float,
    phase: float,
    release: float,
    steps: int,
    orbit: NDArray[np.float64],
) -> None:
    """Fill `orbit` (θ and θ′, shape (2, turns + 1)) at the bottoms of the stroke.

    The steps divide a turn; those before the first bottom are as many, and shorter.
    """
    lead = -phase / (2.0 * math.pi)
    lead -= math.floor(lead)
    turn = 2.0 * math.pi / speed
    angle, rate = release, 0.0
    for i in range(orbit.shape[1]):
        span = lead * turn if i == 0 else turn
        start = phase if i == 0 else 0.0
        h = span / steps
        torque = (weight + drive * math.cos(start)) * math.sin(angle)
        for n in range(steps):
            rate += 0.5 * h * torque
            angle += h * rate
            torque = (weight + drive * math.cos(start + speed * h * (n + 1))) * math.sin(angle)
            rate += 0.5 * h * torque
        orbit[0, i] = angle
        orbit[1, i] = rate
