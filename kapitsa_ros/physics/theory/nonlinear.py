"""Slow frequency of large swings: the rotation number of the stroboscopic map."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.errors import ParameterError, PhysicsError
from kapitsa_ros.physics.kernels import layout
from kapitsa_ros.physics.kernels.cosine import advance_cosine
from kapitsa_ros.physics.kernels.mathieu import half_period
from kapitsa_ros.physics.stepping import steps_per_turn
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact
from kapitsa_ros.physics.theory.mathieu import mathieu_a, mathieu_q

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.physics.parameters import PlantParameters

SWINGS = 40
FEWEST_TURNS = 400
MOST_TURNS = 40_000


def slow_frequency_nonlinear(plant: PlantParameters, speed: float, release: float, phase: float = 0.0) -> float:
    """Return Ω of the frictionless rod let go at rest, rad/s.

    The orbit of the stroboscopic map lies on a closed curve round upright; Ω is its mean angle a turn over the forcing
    period, averaged with smooth weights, which converge faster than any power of the number of turns (Das, Saiki,
    Sander & Yorke, Nonlinearity 30 (2017) 4111).

    Parameters
    ----------
    plant
        Its friction and play do not enter.
    speed
        ω, rad/s.
    release
        θ at rest at time 0, rad.
    phase
        p of the pivot at that time, rad: 0 is the bottom of the stroke.

    Raises
    ------
    ParameterError
        The release is upright or beyond the horizontal.
    PhysicsError
        The rod does not swing round upright: it falls over, or the upright is not stable.

    """
    if not 0 < abs(release) < math.pi / 2:
        raise ParameterError(f'release is {release} rad: give an angle within ±π/2 that is not 0')
    linear = slow_frequency_exact(plant, speed)
    if linear is None:
        raise PhysicsError(f'at {speed:.6g} rad/s the upright is not stable: there is no slow oscillation')
    per_turn = 2.0 * math.pi * linear / speed
    turns = min(max(FEWEST_TURNS, math.ceil(SWINGS * 2.0 * math.pi / per_turn)), MOST_TURNS)
    orbit = _orbit(plant, speed, release, phase, turns)
    x1, r1, x2, r2 = half_period(mathieu_a(plant, speed), mathieu_q(plant))
    # Whole-period monodromy is [[·, 2 x₂r₂], [2 x₁r₁, ·]]: this scale makes the small orbits circles.
    scale = math.sqrt(abs(x2 * r2 / (x1 * r1))) * 2.0 / speed
    angle = np.arctan2(scale * orbit[1], orbit[0])
    return _mean_step(np.mod(angle[:-1] - angle[1:], 2.0 * math.pi)) * speed / (2.0 * math.pi)


def _orbit(plant: PlantParameters, speed: float, release: float, phase: float, turns: int) -> NDArray[np.float64]:
    """Return θ and θ′ each time the pivot is at the bottom, where the small orbits' axes lie along θ and θ′."""
    smooth = replace(plant, damping=0.0, coulomb=0.0, clearance=0.0)
    constants = layout.constants(smooth, stop=math.pi / 2, linear=False)
    state = layout.state_at_rest(release, 0.0)
    state[layout.MODE] = layout.MOVING
    stride = steps_per_turn(smooth, speed)
    step = 1.0 / stride
    start = (phase / (2.0 * math.pi)) % 1.0
    lead = 1.0 - start
    motion = np.empty((2, 2))
    advance_cosine(
        plant.amplitude,
        speed,
        start,
        lead * step * 2.0 * math.pi / speed,
        lead * step,
        stride,
        constants,
        state,
        motion,
    )
    orbit = np.empty((2, turns + 1))
    period = 2.0 * math.pi / speed
    advance_cosine(plant.amplitude, speed, 0.0, period * step, step, stride, constants, state, orbit)
    if state[layout.MODE] != layout.MOVING:
        raise PhysicsError(f'released at {release:.6g} rad and {speed:.6g} rad/s the rod falls over')
    return orbit


def _mean_step(steps: NDArray[np.float64]) -> float:
    """Average with the bump exp(−1/(t(1 − t)))."""
    time = (np.arange(steps.size) + 1.0) / (steps.size + 1.0)
    weight = np.exp(-1.0 / (time * (1.0 - time)))
    return float(np.sum(weight * steps) / np.sum(weight))
