"""Slow frequency of large swings: the rotation number of the stroboscopic map."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kapitsa_ros.physics.errors import ParameterError, PhysicsError
from kapitsa_ros.physics.release import Release
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact
from kapitsa_ros.physics.theory.floquet_amplitude import mean_turn, slow_amplitude

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant

SWINGS = 40
FEWEST_TURNS = 400
MOST_TURNS = 40_000


def slow_frequency_nonlinear(plant: Plant, speed: float, release: float, phase: float = 0.0) -> float:
    """Return Ω of the frictionless rod let go at rest, rad/s.

    The orbit of the stroboscopic map lies on a closed curve round upright; Ω is its mean angle a turn over the forcing
    period.

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
    if release == 0:
        raise ParameterError('release is 0 rad: an upright rod does not swing, give an angle')
    smooth = plant.without_losses()
    linear = slow_frequency_exact(smooth, speed)
    if linear is None or 2.0 * linear >= speed:  # half the speed is the upper edge of stability
        raise PhysicsError(f'at {speed:.6g} rad/s the upright is not stable: there is no slow oscillation')
    rotation = linear / speed
    turns = min(max(FEWEST_TURNS, math.ceil(SWINGS / min(rotation, 1.0 - 2.0 * rotation))), MOST_TURNS)
    orbit = Release(plant=smooth, speed=speed, angle=release, phase=phase).strobed(turns)
    if orbit.fell:
        raise PhysicsError(f'released at {release:.6g} rad and {speed:.6g} rad/s the rod falls over')
    amplitude = slow_amplitude(smooth, speed, orbit.angle, orbit.rate)
    return mean_turn(amplitude, 2.0 * math.pi * rotation) * speed / (2.0 * math.pi)
