# ruff: noqa: PLR0917 (compiled functions take their arrays by position)
"""The rod on a sampled pivot: one block of samples, each interval a polynomial of the pivot's motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.kernels.hermite import acceleration_series
from kapitsa_ros.physics.kernels.jit import kernel
from kapitsa_ros.physics.kernels.layout import ANGLE, COULOMB, DAMPING, GRAVITY, HELD, MODE, MOVING, RATE, RELEASING
from kapitsa_ros.physics.kernels.rod import ANGLE_SERIES, WORK_ROWS, advance_interval, torque
from kapitsa_ros.physics.kernels.roots import NEVER, ROOM_ROWS, first_descent
from kapitsa_ros.physics.kernels.series import value

if TYPE_CHECKING:
    from numpy.typing import NDArray

ORDER = 13
COARSEST = 1e-7  # highest coefficient over the sum: keeps 1e-9 rad over ten seconds
ROUNDING = 1e-12  # of the pivot's position: what its last bits may put into that coefficient
TRUNCATION = 1e-11  # rad, the last term of the angle's series
ON_TIME = 1e-9  # of a sample period: a bottom this little past counts as now
DONE, TOO_COARSE, TOO_MANY_EVENTS, TOO_FAST = range(4)
_VELOCITY, _ROOM = WORK_ROWS, WORK_ROWS + 1
"""Rows of the work space beside those of `rod`; from _ROOM on they are those of `first_descent`."""
WORK_SHAPE = (_ROOM + ROOM_ROWS, ORDER + 1)


@kernel
def advance_block(
    weights: NDArray[np.float64],
    period: float,
    pivot: NDArray[np.float64],
    plant: NDArray[np.float64],
    state: NDArray[np.float64],
    motion: NDArray[np.float64],
    load: NDArray[np.float64],
    work: NDArray[np.float64],
) -> int:
    """Carry the state through a block.

    Parameters
    ----------
    weights
        From `hermite.stencil_weights`.
    period
        h, seconds from sample to sample.
    pivot
        y, y′, y″; shape (3, N + 1).
    plant, state
        As `layout` has them; `state` is changed in place.
    motion
        θ, θ′, θ″ on return; shape (3, N + 1).
    load, work
        Work space: shape (N, columns of the weights), and WORK_SHAPE.

    Returns
    -------
    int
        DONE; TOO_COARSE, with nothing changed; TOO_MANY_EVENTS, where events could not be resolved; TOO_FAST,
        where the rod moves more between two samples than a series of this order holds.

    """
    intervals = pivot.shape[1] - 1
    acceleration_series(weights, period, pivot[0], pivot[1], pivot[2], load)
    weight = period * period * plant[GRAVITY]
    if _too_coarse(load, weight, pivot[0]):
        return TOO_COARSE

    work[:] = 0.0
    _record(load[0, 0] + weight, period, plant, state, motion[:, 0])
    for i in range(intervals):
        start = 0.0
        if state[MODE] == HELD:
            start = _release(period * pivot[1, i], load[i], state, work[_VELOCITY:])
        load[i, 0] += weight
        if start < 1.0 and not advance_interval(load[i], start, period, plant, state, work):
            return TOO_MANY_EVENTS
        if not abs(work[ANGLE_SERIES, -1]) <= TRUNCATION:
            return TOO_FAST
        at_end = load[i + 1, 0] + weight if i + 1 < intervals else value(load[i], 1.0)
        _record(at_end, period, plant, state, motion[:, i + 1])
    return DONE


@kernel
def _too_coarse(load: NDArray[np.float64], weight: float, position: NDArray[np.float64]) -> bool:
    """Tell whether the series of the pivot's acceleration still has something to say where it ends."""
    highest, rounding = 0.0, 0.0
    for i in range(position.size):
        rounding = max(rounding, ROUNDING * abs(position[i]))
    for i in range(load.shape[0]):
        total = weight
        for n in range(load.shape[1]):
            total += abs(load[i, n])
        highest = max(highest, abs(load[i, -1]) - COARSEST * total)
    return highest > rounding


@kernel
def _release(
    velocity: float, acceleration: NDArray[np.float64], state: NDArray[np.float64], work: NDArray[np.float64]
) -> float:
    """Return the τ at which the catch lets go, at the bottom of the stroke or where the pivot rests; else `NEVER`."""
    if state[RELEASING] == 0.0:
        return NEVER
    velocity_series = work[0, : acceleration.size + 1]
    velocity_series[0] = velocity
    for n in range(acceleration.size):
        velocity_series[n + 1] = acceleration[n] / (n + 1.0)
    resting = True
    for n in range(velocity_series.size):
        resting &= velocity_series[n] == 0.0
    at = NEVER
    if resting or (velocity_series[1] > 0.0 and abs(velocity_series[0]) < ON_TIME * velocity_series[1]):
        at = 0.0
    elif velocity_series[0] < 0.0:
        for n in range(velocity_series.size):
            velocity_series[n] = -velocity_series[n]
        at = first_descent(velocity_series, 1.0, work[1:])
    if at < 1.0:
        state[MODE] = MOVING
        state[RELEASING] = 0.0
    return at


@kernel
def _record(
    load: float,
    period: float,
    plant: NDArray[np.float64],
    state: NDArray[np.float64],
    sample: NDArray[np.float64],
) -> None:
    """Write θ, θ′ and θ″ from the equation of motion."""
    sample[0] = state[ANGLE]
    sample[1] = state[RATE]
    sample[2] = 0.0
    if state[MODE] == MOVING:
        free = torque(load, plant, state) / (period * period) - plant[DAMPING] * state[RATE]
        sample[2] = free - plant[COULOMB] * np.sign(state[RATE])
