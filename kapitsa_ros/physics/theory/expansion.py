"""The next order: the slow frequency and the threshold from the power series of Mathieu's characteristic value.

λ_ν(q) = ν² + q²/(2(ν² − 1)) + (5ν² + 7) q⁴/(32 (ν² − 1)³ (ν² − 4)) + … (DLMF 28.15.1), with ν = 2Ω/ω. Its first two
terms at small ν are the averaged equation. Damping adds c²/ω² to −a, and at the threshold ν² = −c²/ω².
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy

from kapitsa_ros.physics.theory.averaged import omega_crit_averaged, slow_frequency_averaged
from kapitsa_ros.physics.theory.mathieu import mathieu_a, mathieu_q

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant


def characteristic_series(nu_squared: float, q: float) -> float:
    """Return λ_ν(q) up to q⁴ (DLMF 28.15.1); ν² may be negative."""
    near, far = nu_squared - 1.0, nu_squared - 4.0
    return nu_squared + q**2 / (2.0 * near) + (5.0 * nu_squared + 7.0) * q**4 / (32.0 * near**3 * far)


def omega_crit_next_order(plant: Plant) -> float:
    """Return the critical speed with damping, rad/s; its expansion begins √(ω_crit² + c²)."""
    q = mathieu_q(plant)

    def excess(speed: float) -> float:
        ratio = (plant.damping / speed) ** 2
        return mathieu_a(plant, speed) - ratio - characteristic_series(-ratio, q)

    averaged = np.hypot(omega_crit_averaged(plant), plant.damping)
    return float(scipy.optimize.brentq(excess, 0.5 * averaged, 2.0 * averaged, rtol=1e-14))


def slow_frequency_next_order(plant: Plant, speed: float) -> float | None:
    """Return Ω with damping, rad/s; None where the averaged equation has none."""
    averaged = slow_frequency_averaged(plant, speed)
    if averaged is None:
        return None
    q = mathieu_q(plant)
    goal = mathieu_a(plant, speed) - (plant.damping / speed) ** 2
    highest = min(4.0 * (2.0 * averaged / speed) ** 2, 0.99)
    if characteristic_series(0.0, q) > goal or characteristic_series(highest, q) < goal:
        return None
    square = float(
        scipy.optimize.brentq(lambda nu_squared: characteristic_series(nu_squared, q) - goal, 0.0, highest, xtol=1e-16)
    )
    return 0.5 * speed * float(np.sqrt(square))
