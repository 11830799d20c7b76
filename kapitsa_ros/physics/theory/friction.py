"""Dry friction under dither: describing function, loss of amplitude, and where the rod comes to rest (report, § 6)."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import scipy

from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.release import Release
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant

SETTLING_TURNS = 4000


def equivalent_damping(plant: Plant, speed: float, swing: float) -> float:
    """Return the viscous coefficient of dithered friction at small slow velocities, 1/s: 2f/(πkλω|θ₁|).

    For the rod that is 4Lf/(3πλω|θ₁|) (report, eq. 21, with its φ for f). The condition, |θ₁′| ≪ kλω|θ₁| (eq. 22),
    fails in this experiment: see `dither_ratio`.
    """
    return 2.0 * plant.coulomb / (math.pi * plant.k * plant.amplitude * speed * abs(swing))


def dither_ratio(plant: Plant, speed: float) -> float:
    """Return r, the largest slow velocity over the largest fast one: Ω/(kλω) (report, eq. 22)."""
    slow = slow_frequency_exact(plant, speed)
    if slow is None:
        raise PhysicsError(f'at {speed:.6g} rad/s the upright is not stable: there is no slow oscillation')
    return slow / (plant.k * plant.amplitude * speed)


def dithered_factor(ratio: float) -> float:
    """Return K(r) = ∮ (2/π) asin(min(1, r|tan ψ|)) |sin ψ| dψ: the friction work of a dithered slow cycle.

    A slow cycle is θ₁ = A cos ψ; within it the fast velocity's amplitude is kλω|θ₁|, and dither lets the share
    (2/π) asin of the friction through. By parts, and with sin u = r tan ψ, it is 8/π times the complete elliptic
    integral of the first kind of parameter −1/r². Without dither (r → ∞) K = 4.
    """
    return 8.0 / math.pi * float(scipy.special.ellipk(-1.0 / ratio**2))


def amplitude_loss(plant: Plant, speed: float) -> float:
    """Return what Coulomb friction takes from the slow amplitude in a slow period, rad: f K/Ω² at any amplitude."""
    ratio = dither_ratio(plant, speed)
    slow = ratio * plant.k * plant.amplitude * speed
    return plant.coulomb * dithered_factor(ratio) / slow**2


def stuck_zone(plant: Plant, speed: float) -> float:
    """Return θ_s = f/(k(g + λω²)), rad: within it the rod sticks for good."""
    return plant.coulomb / (plant.k * (plant.gravity + plant.amplitude * speed**2))


def buzz_angle(plant: Plant, speed: float) -> float:
    """Return the off-upright angle at which a swing ends, rad, seen at the bottom of the stroke.

    From outside, the rod does not reach the stuck zone: it is left sliding to and fro. The motion near upright scales
    with f, so the linear equation followed to its limit tells it.
    """
    if plant.coulomb == 0:
        return 0.0
    small = replace(plant.without_losses(), damping=plant.damping, coulomb=1e-3)
    rest = Release(plant=small, speed=speed, angle=10.0 * stuck_zone(small, speed), linear=True)
    return abs(float(rest.strobed(SETTLING_TURNS).angle[-1])) * plant.coulomb / small.coulomb
