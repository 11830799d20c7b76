"""Slow frequency of large swings: the rotation number of the stroboscopic map."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kapitsa_ros.physics.errors import ParameterError, PhysicsError
from kapitsa_ros.physics.release import Release
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact
from kapitsa_ros.physics.theory.floquet_amplitude import FEW_SWINGS, mean_turn, mean_turn_of_few, slow_amplitude

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from kapitsa_ros.physics.plant import Plant

SWINGS = 40
FEWEST_TURNS = 400
MOST_TURNS = 40_000
_SLOW = 1.0 / 16.0  # swings a turn up to which the strobe shows overtones of the swing as they are, not as slower ones
_SOFTENED = 0.8  # of the small swing's frequency: below, the window for few swings has too few of them


def slow_frequency_nonlinear(plant: Plant, speed: float, release: float, phase: float = 0.0) -> float:
    """Return Ω of the frictionless rod let go at rest, rad/s.

    The orbit of the stroboscopic map lies on a closed curve round upright; Ω is its mean angle a turn over the forcing
    period. Few swings will do where each takes many turns: all else that oscillates is faster, and a window forgets it.

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
    if FEW_SWINGS / MOST_TURNS <= rotation <= _SLOW:
        amplitude = _strobed(smooth, speed, release, phase, math.ceil(FEW_SWINGS / rotation))
        found = mean_turn_of_few(amplitude, 2.0 * math.pi * rotation) * speed / (2.0 * math.pi)
        if found >= _SOFTENED * linear:
            return found
    turns = min(max(FEWEST_TURNS, math.ceil(SWINGS / min(rotation, 1.0 - 2.0 * rotation))), MOST_TURNS)
    amplitude = _strobed(smooth, speed, release, phase, turns)
    return mean_turn(amplitude, 2.0 * math.pi * rotation) * speed / (2.0 * math.pi)


def _strobed(plant: Plant, speed: float, release: float, phase: float, turns: int) -> NDArray[np.complex128]:
    """Return the amplitude at the bottoms of the stroke."""
    orbit = Release(plant=plant, speed=speed, angle=release, phase=phase).strobed(turns)
    if orbit.fell:
        raise PhysicsError(f'released at {release:.6g} rad and {speed:.6g} rad/s the rod falls over')
    return slow_amplitude(plant, speed, orbit.angle, orbit.rate)
