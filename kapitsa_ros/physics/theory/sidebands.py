"""The lines of the motion's spectrum: Ω and ω ± Ω, and none at ω itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact
from kapitsa_ros.physics.theory.mathieu import mathieu_a, mathieu_q

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant

HARMONICS = 30


def sidebands(plant: Plant, speed: float) -> tuple[float, float]:
    """Return the amplitudes of the lines at ω − Ω and ω + Ω over that at Ω, for small undamped swings.

    The solution is Σ c_m cos((Ω + mω)t) with c_m (a − (ν + 2m)²) = q (c_{m−1} + c_{m+1}), ν = 2Ω/ω (DLMF 28.14); its
    ratios are continued fractions.

    Raises
    ------
    PhysicsError
        The upright is not stable: there are no lines.

    """
    slow = slow_frequency_exact(plant, speed)
    if slow is None:
        raise PhysicsError(f'at {speed:.6g} rad/s the upright is not stable: its spectrum has no lines')
    a, q, nu = mathieu_a(plant, speed), mathieu_q(plant), 2.0 * slow / speed
    return abs(_ratio(a, q, nu, -2)), abs(_ratio(a, q, nu, 2))


def _ratio(a: float, q: float, nu: float, direction: int) -> float:
    """Return c₋₁/c₀ or c₁/c₀ by the continued fraction, from far out inwards."""
    ratio = 0.0
    for m in range(HARMONICS, 0, -1):
        ratio = q / (a - (nu + direction * m) ** 2 - q * ratio)
    return ratio
