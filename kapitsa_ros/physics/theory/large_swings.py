"""Large swings in the effective potential of the fast vibration.

Averaged without small angles: θ₁″ = kg sin θ₁ − ½k²λ²ω² sin θ₁ cos θ₁ (Landau & Lifshitz, Mechanics, § 30; Butikov,
Am. J. Phys. 69 (2001) 755). The swing is slower than a small one, and a barrier lies at cos θ = 2g/(kλ²ω²).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import scipy

from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.theory.averaged import slow_frequency_averaged
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant


def slow_start(plant: Plant, speed: float, release: float, phase: float = 0.0) -> tuple[float, float]:
    """Return θ₁ and θ₁′ of a rod released at rest, from θ = θ₁ (1 − kλ cos(ωt + p)) (report, eq. 12)."""
    swing = plant.k * plant.amplitude
    angle = release / (1.0 - swing * math.cos(phase))
    return angle, -angle * swing * speed * math.sin(phase) / (1.0 - swing * math.cos(phase))


def slow_swing(plant: Plant, speed: float, release: float, phase: float = 0.0) -> float:
    """Return the amplitude of the slow motion of a rod released at rest, rad; mid-stroke releases swing the farthest.

    Raises
    ------
    PhysicsError
        The slow motion has no turning point before the barrier: the rod falls over.

    """
    start, rate = slow_start(plant, speed, release, phase)
    stiffness = 0.5 * (plant.k * plant.amplitude * speed) ** 2
    weight = plant.k * plant.gravity
    # Energy ½θ′² + kg cos θ + ½S sin²θ with S = ½k²λ²ω²; x = cos of the turning angle solves a quadratic.
    energy = 0.5 * rate**2 + weight * math.cos(start) + 0.5 * stiffness * math.sin(start) ** 2
    root = weight**2 - stiffness * (2.0 * energy - stiffness)
    turning = (weight + math.sqrt(root)) / stiffness if root >= 0 else math.inf
    if not turning <= 1:
        raise PhysicsError(f'released at {release:.6g} rad and {speed:.6g} rad/s the rod falls over')
    return math.acos(turning)


def slow_frequency_large(plant: Plant, speed: float, amplitude: float) -> float | None:
    """Return Ω of slow swings of a given amplitude, rad/s: the exact small-swing value times the potential's softening.

    Parameters
    ----------
    plant
        Its friction and play do not enter but for the damping of the linear theory.
    speed
        ω, rad/s.
    amplitude
        Of the slow motion θ₁, rad.

    Returns
    -------
    float or None
        None where small swings have no frequency.

    """
    small, averaged = slow_frequency_exact(plant, speed), slow_frequency_averaged(plant, speed)
    if small is None or averaged is None:
        return None
    stiffness = 0.5 * (plant.k * plant.amplitude * speed) ** 2
    weight = plant.k * plant.gravity
    edge = math.sin(0.5 * amplitude)

    def time(psi: float) -> float:
        # sin(θ/2) = sin(A/2) sin ψ takes the turning points out of the period's integral.
        half = edge * math.sin(psi)
        rise = edge**2 + half**2
        return 1.0 / math.sqrt((stiffness * (1.0 - rise) - weight) * (1.0 - half**2))

    if stiffness * (1.0 - 2.0 * edge**2) <= weight:
        raise PhysicsError(f'a slow swing of {amplitude:.6g} rad passes the barrier: the rod falls over')
    return small * math.pi / (2.0 * averaged * float(scipy.integrate.quad(time, 0.0, 0.5 * math.pi, epsrel=1e-12)[0]))
