"""Many releases at once: where each rod is after the same time."""

from __future__ import annotations

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.errors import ParameterError, PhysicsError
from kapitsa_ros.physics.kernels import layout
from kapitsa_ros.physics.kernels.batch import advance_batch
from kapitsa_ros.physics.kernels.cosine import TOO_MANY_EVENTS, WORK_SHAPE
from kapitsa_ros.physics.release import PROMISED, REFINEMENTS, STOP
from kapitsa_ros.physics.step_size import longest_step

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from kapitsa_ros.physics.plant import Plant


@dataclass(frozen=True, kw_only=True, eq=False)
class FinalStates:
    """Where rods have come to, one entry each."""

    angle: NDArray[np.float64]
    """θ, rad."""
    rate: NDArray[np.float64]
    """θ′, rad/s."""
    fell: NDArray[np.bool_]
    stuck: NDArray[np.bool_]


def simulate_batch(
    plant: Plant,
    *,
    speed: ArrayLike,
    angle: ArrayLike,
    phase: ArrayLike = 0.0,
    duration: float,
) -> FinalStates:
    """Release rods at rest at time 0 and integrate them on all cores; no motion is kept.

    Parameters
    ----------
    plant
        The same for all.
    speed, angle, phase
        ω (rad/s), θ (rad) and p (rad); they broadcast to one dimension.
    duration
        s.

    Raises
    ------
    ParameterError
        A value is not finite or out of its range.
    PhysicsError
        The promised accuracy cannot be kept, or impacts are too close together.

    """
    speeds, angles, phases = (
        np.ascontiguousarray(array, dtype=float) for array in np.broadcast_arrays(*np.atleast_1d(speed, angle, phase))
    )
    if not (np.all(np.isfinite(speeds)) and np.all(speeds > 0)):
        raise ParameterError('a speed is not finite and above 0 rad/s')
    if not np.all(np.abs(angles) < STOP):
        raise ParameterError('a release angle does not lie within ±π/2')
    if not (np.all(np.isfinite(phases)) and 0 < duration < math.inf):
        raise ParameterError('give finite phases and a finite duration above 0 s')
    stride = np.array([float(math.ceil(duration / longest_step(plant, float(one)))) for one in speeds])
    states = _follow(plant, speeds, angles, np.mod(phases / (2.0 * np.pi), 1.0), duration, stride)
    mode = states[:, layout.MODE]
    return FinalStates(
        angle=states[:, layout.ANGLE].copy(),
        rate=states[:, layout.RATE].copy(),
        fell=mode >= layout.FALLEN,
        stuck=mode == layout.STUCK,
    )


def _follow(  # noqa: PLR0917
    plant: Plant,
    speeds: NDArray[np.float64],
    angles: NDArray[np.float64],
    starts: NDArray[np.float64],
    duration: float,
    stride: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the states the rods end in; a wild swing makes all take shorter steps."""
    constants = layout.constants(plant, stop=STOP, linear=False)
    truncation = np.empty(speeds.size)

    def advance(part: slice) -> None:
        advance_batch(
            plant.amplitude,
            speeds[part],
            starts[part],
            duration / steps[part],
            steps[part],
            constants,
            states[part],
            truncation[part],
            np.empty((2, 2)),
            np.empty(WORK_SHAPE),
        )

    for refinement in REFINEMENTS:
        states = np.tile(layout.state_at_rest(0.0, plant.clearance), (speeds.size, 1))
        states[:, layout.ANGLE] = angles
        states[:, layout.MODE] = layout.MOVING
        steps = stride * refinement
        with ThreadPoolExecutor() as threads:  # a kernel does not hold the interpreter's lock
            list(threads.map(advance, _parts(speeds.size)))
        if np.any(truncation == TOO_MANY_EVENTS):
            raise PhysicsError('impacts at a pivot are too close together to be resolved: reduce restitution')
        if truncation.max() <= PROMISED:
            return states
    raise PhysicsError(f'a step leaves out {truncation.max():.1g} rad: a rod swings too wildly for 1e-8 rad')


def _parts(count: int) -> list[slice]:
    """Cut rods into parts for all cores; some are followed faster than others."""
    ends = np.linspace(0, count, 8 * (os.cpu_count() or 1) + 1).astype(int).tolist()
    return [slice(*part) for part in pairwise(ends) if part[0] < part[1]]
