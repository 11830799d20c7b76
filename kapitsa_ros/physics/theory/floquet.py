"""Exact linear theory: Floquet multipliers of the damped equation, thresholds, slow frequency and growth.

Over one turn of the shaft the multipliers are e^(−cT/2) (D ± √(D² − 1)), D half the trace for w of `mathieu`. With the
two normal solutions at half a period (D − 1)/2 = x₁′x₂ and (D + 1)/2 = x₁x₂′, so nothing is lost where D is near ±1.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import scipy

from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.kernels.mathieu import WORK_SHAPE, floquet_exponents
from kapitsa_ros.physics.limits import FASTEST, check_forcing
from kapitsa_ros.physics.theory.mathieu import (
    characteristic_a0,
    characteristic_a1,
    characteristic_b1,
    half_period,
    mathieu_q,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.physics.plant import Plant

LONGEST_FALL = 1e4  # of √−a: a turn would multiply the fall by e^(πLONGEST_FALL), beyond any double
MOST_DAMPED = 350.0  # sinh² of more is beyond any double
_TOLERANCE = 4.0 * np.finfo(float).eps


def omega_crit_exact(plant: Plant) -> float:
    """Return the speed from which the upright rod is stable, rad/s: a multiplier leaves +1 inwards."""
    q = mathieu_q(plant)
    undamped = math.sqrt(-characteristic_a0(q)) / _stiffness(plant)
    if plant.damping == 0:
        return 1.0 / undamped

    def excess(inverse_speed: float) -> float:
        _, r1, x2, _ = _normal_solutions(plant, inverse_speed)
        return r1 * x2 - _damping_allowance(plant, inverse_speed)

    further = 1.1 * undamped
    while excess(further) <= 0:
        further *= 1.1
    # From within the stable side: where damping is slight, rounding decides the sign at the undamped threshold.
    return 1.0 / float(scipy.optimize.brentq(excess, 0.99 * undamped, further, xtol=1e-300, rtol=_TOLERANCE))


def omega_crit_upper(plant: Plant) -> float | None:
    """Return the speed from which the upright rod is unstable again, rad/s: a multiplier leaves through −1.

    Returns
    -------
    float or None
        None where the rod stays stable however fast: without damping that is up to 3λ/L = 0.9080.

    """
    q = mathieu_q(plant)
    edge = characteristic_b1(q)
    if edge >= 0:
        return None
    slowest = math.sqrt(-edge) / _stiffness(plant)
    if plant.damping == 0:
        return 1.0 / slowest

    def excess(inverse_speed: float) -> float:
        x1, _, _, r2 = _normal_solutions(plant, inverse_speed)
        return x1 * r2 + _damping_allowance(plant, inverse_speed)

    fastest = math.sqrt(max(-characteristic_a1(q), 0.0)) / _stiffness(plant)
    unstable = next((s for s in np.linspace(slowest, fastest, 200)[1:] if excess(s) < 0), None)
    if unstable is None:
        return None
    stable = slowest - 0.01 * (fastest - slowest)
    return 1.0 / float(scipy.optimize.brentq(excess, unstable, stable, xtol=1e-300, rtol=_TOLERANCE))


def slow_frequency_exact(plant: Plant, speed: float) -> float | None:
    """Return Ω, rad/s: the angle of the Floquet multipliers over the forcing period.

    Returns
    -------
    float or None
        None where both multipliers are real and positive: no slow oscillation. ω/2 beyond the upper limit.

    """
    sine = -_half_trace(plant, speed)[0]
    if sine <= 0:
        return None
    return speed / math.pi * math.asin(math.sqrt(min(sine, 1.0)))


def growth_rate(plant: Plant, speed: float) -> float:
    """Return the rate at which the slow motion grows, 1/s (negative: decays): ln of the larger multiplier over T."""
    less_one, plus_one = _half_trace(plant, speed)
    period = 2.0 * math.pi / speed
    spread = 0.0
    if less_one > 0:
        spread = 2.0 * math.asinh(math.sqrt(less_one))
    elif plus_one < 0:
        spread = 2.0 * math.asinh(math.sqrt(-plus_one))
    return spread / period - 0.5 * plant.damping


def is_stable(plant: Plant, speed: float) -> bool:
    """Tell whether the upright rod stays up: no multiplier lies outside the unit circle."""
    return growth_rate(plant, speed) <= 0


def floquet_curves(plant: Plant, speeds: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return `slow_frequency_exact` and `growth_rate` at many speeds at once.

    Parameters
    ----------
    plant
        The rod.
    speeds
        ω, rad/s, shape (N,).

    Returns
    -------
    tuple
        Ω, rad/s, and the growth, 1/s, shape (N,) each. Ω is nan where there is no slow oscillation; both are nan at a
        speed that is not above 0, beyond `FASTEST`, or so low that the fall within a turn is beyond double precision.

    """
    slow, growth = np.full(speeds.shape, np.nan), np.full(speeds.shape, np.nan)
    stiffness = _stiffness(plant)
    answered = (speeds <= FASTEST) & (speeds > stiffness / LONGEST_FALL)
    speed = speeds[answered]
    rate = stiffness * (1.0 / speed)
    half_angle, spread = np.empty(speed.shape), np.empty(speed.shape)
    floquet_exponents(-rate * rate, mathieu_q(plant), half_angle, spread, np.empty(WORK_SHAPE))
    slow[answered] = speed / math.pi * half_angle
    growth[answered] = spread / (2.0 * math.pi / speed) - 0.5 * plant.damping
    return slow, growth


def _half_trace(plant: Plant, speed: float) -> tuple[float, float]:
    """Return (D − 1)/2 and (D + 1)/2."""
    check_forcing(speed)
    x1, r1, x2, r2 = _normal_solutions(plant, 1.0 / speed)
    if not math.isfinite(r1 * x2):
        raise PhysicsError(f'at {speed} rad/s the rod falls too fast within one turn for double precision')
    return r1 * x2, x1 * r2


def _normal_solutions(plant: Plant, inverse_speed: float) -> tuple[float, float, float, float]:
    rate = _stiffness(plant) * inverse_speed
    if rate > LONGEST_FALL:
        raise PhysicsError(
            f'at {1.0 / inverse_speed:.3g} rad/s the rod falls too fast within one turn for double precision'
        )
    return half_period(-rate * rate, mathieu_q(plant))


def _damping_allowance(plant: Plant, inverse_speed: float) -> float:
    """Return sinh²(πc/2ω): what damping allows half the trace beyond ±1, halved."""
    exponent = 0.5 * math.pi * plant.damping * inverse_speed
    if exponent > MOST_DAMPED:
        raise PhysicsError(f'damping of {plant.damping:.3g} 1/s hides the threshold from double precision: reduce it')
    return math.sinh(exponent) ** 2


def _stiffness(plant: Plant) -> float:
    """Return √(4kg + c²): w of the damped rod has a = −(4kg + c²)/ω²."""
    return math.sqrt(4.0 * plant.k * plant.gravity + plant.damping**2)
