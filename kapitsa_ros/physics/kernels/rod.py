# ruff: noqa: PLR0917 (compiled functions take their arrays by position)
"""The rod over one interval of smooth pivot motion: free, sliding with friction, stuck, falling, in play.

Between events the motion is one power series; every event (reversal, stick, slip, lift-off, impact, stop) is the first
root of a polynomial, so switching is exact and nothing is smoothed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kapitsa_ros.physics.kernels.jit import kernel
from kapitsa_ros.physics.kernels.layout import (
    ANGLE,
    CLEARANCE,
    CONTACT,
    COULOMB,
    DAMPING,
    FALLEN,
    GAP,
    GAP_RATE,
    IN_FLIGHT,
    LINEAR,
    MODE,
    MOVING,
    RATE,
    STOP,
    STUCK,
    K,
)
from kapitsa_ros.physics.kernels.play import expand_gap, time_to_touch, touch
from kapitsa_ros.physics.kernels.roots import NEVER, ROOM_ROWS, first_descent
from kapitsa_ros.physics.kernels.series import expand, shift, value_and_slope

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MOST_PIECES = 10_000
ANGLE_SERIES, SINE, COSINE, SLOPE, DRIVE, GAP_SERIES, LOAD, EVENT, SUMS, ROOM = range(10)
"""Rows of the work space; from ROOM on they are those of `first_descent`."""
WORK_ROWS = ROOM + ROOM_ROWS


@kernel
def advance_interval(
    load: NDArray[np.float64],
    start: float,
    step: float,
    plant: NDArray[np.float64],
    state: NDArray[np.float64],
    work: NDArray[np.float64],
) -> bool:
    """Carry the state from τ = `start` to the interval's end, τ = 1.

    Parameters
    ----------
    load
        Coefficients in τ of h² (g + y″).
    start
        In [0, 1).
    step
        h, seconds.
    plant, state
        As `layout` has them; `state` is changed in place.
    work
        Work space, shape (WORK_ROWS, order + 1). On return row ANGLE_SERIES has the last series of θ.

    Returns
    -------
    bool
        False where events are too close together to be resolved.

    """
    if state[MODE] != MOVING and state[MODE] != STUCK:
        return True
    if plant[COULOMB] == 0.0 and state[CLEARANCE] == 0.0 and start == 0.0:
        _advance_freely(load, step, plant, state, work)
        return True
    return _advance_by_pieces(load, start, step, plant, state, work)


@kernel
def _advance_freely(
    load: NDArray[np.float64],
    step: float,
    plant: NDArray[np.float64],
    state: NDArray[np.float64],
    work: NDArray[np.float64],
) -> None:
    """Carry the state over a whole interval without friction and play: no event but the stop."""
    angle = work[ANGLE_SERIES]
    _expand_angle(load, 0.0, step, plant, state, work)
    change, slope, bound = 0.0, 0.0, abs(angle[0])
    for n in range(angle.size - 1, 0, -1):
        change += angle[n]
        slope += n * angle[n]
        bound += abs(angle[n])
    if bound >= plant[STOP] and _time_to_stop(plant[STOP], 1.0, work) <= 1.0:
        _rest_at_stop(state, plant)
        return
    state[ANGLE] += change
    state[RATE] = slope / step


@kernel
def _advance_by_pieces(
    load: NDArray[np.float64],
    start: float,
    step: float,
    plant: NDArray[np.float64],
    state: NDArray[np.float64],
    work: NDArray[np.float64],
) -> bool:
    """Go from event to event; the load is re-centred at each."""
    given, load = load, work[LOAD, : load.size]
    for n in range(load.size):
        load[n] = given[n]
    gap, sums = work[GAP_SERIES, : load.size + 2], work[SUMS, : load.size]
    if start > 0.0:
        shift(load, start, sums)
    has_friction, has_play = plant[COULOMB] != 0.0, state[CLEARANCE] != 0.0
    remaining = 1.0 - start
    slipping, lifting = False, False
    for _ in range(MOST_PIECES):
        change, contact = NEVER, NEVER
        if has_play:
            expand_gap(load, step, state, lifting, gap)
            contact = time_to_touch(load, gap, state, remaining, work[EVENT], work[ROOM:])
        _expand_piece(load, step, plant, state, work, slipping)
        if has_friction:
            change = _time_to_friction_change(load, step, plant, state, remaining, work)
        stop = _time_to_stop(plant[STOP], remaining, work)
        span = min(stop, change, contact, remaining)
        _carry(work[ANGLE_SERIES], gap, span, step, state)
        if span == remaining:
            return True
        shift(load, span, sums)
        remaining -= span
        slipping, lifting = False, False
        if stop == span:
            _rest_at_stop(state, plant)
        elif contact == span:
            lifting = state[CONTACT] != IN_FLIGHT
            touch(load, step, plant, state)
        else:
            slipping = state[MODE] == STUCK
            state[RATE] = 0.0
        if state[MODE] > STUCK:
            return True
    return False


@kernel
def _carry(
    angle: NDArray[np.float64],
    gap: NDArray[np.float64],
    span: float,
    step: float,
    state: NDArray[np.float64],
) -> None:
    """Take the state to the end of a piece."""
    state[ANGLE], slope = value_and_slope(angle, span)
    state[RATE] = slope / step
    if state[CONTACT] == IN_FLIGHT:
        state[GAP], slope = value_and_slope(gap, span)
        state[GAP_RATE] = slope / step


@kernel
def _expand_piece(
    load: NDArray[np.float64],
    step: float,
    plant: NDArray[np.float64],
    state: NDArray[np.float64],
    work: NDArray[np.float64],
    slipping: bool,  # noqa: FBT001
) -> None:
    """Fill the angle's series of a piece, over which the rod slides one way or sticks."""
    friction = _friction(load, step, plant, state, slipping)
    angle = work[ANGLE_SERIES]
    if state[MODE] == STUCK:
        angle[0] = state[ANGLE]
        for n in range(1, angle.size):
            angle[n] = 0.0
        return
    _expand_angle(load, friction, step, plant, state, work)
    if slipping:  # in balance but for the last bit: the motion starts with the third derivative
        angle[2] = 0.0


@kernel
def _expand_angle(
    load: NDArray[np.float64],
    friction: float,
    step: float,
    plant: NDArray[np.float64],
    state: NDArray[np.float64],
    work: NDArray[np.float64],
) -> None:
    angle, drive = work[ANGLE_SERIES], work[DRIVE, :-2]
    k = 0.0 if state[CONTACT] == IN_FLIGHT else plant[K]
    for n in range(load.size):
        drive[n] = k * load[n]
    for n in range(load.size, drive.size):
        drive[n] = 0.0
    angle[0] = state[ANGLE]
    angle[1] = step * state[RATE]
    expand(drive, step * plant[DAMPING], friction, plant[LINEAR] != 0.0, angle, work[SINE], work[COSINE], work[SLOPE])


@kernel
def torque(load: float, plant: NDArray[np.float64], state: NDArray[np.float64]) -> float:
    """Return the load's share of θ″ (times h²)."""
    if state[CONTACT] == IN_FLIGHT:
        return 0.0
    sin_theta: float = state[ANGLE] if plant[LINEAR] != 0.0 else math.sin(state[ANGLE])
    return float(plant[K] * load * sin_theta)


@kernel
def _friction(
    load: NDArray[np.float64],
    step: float,
    plant: NDArray[np.float64],
    state: NDArray[np.float64],
    slipping: bool,  # noqa: FBT001
) -> float:
    """Settle whether the rod slides or sticks at the start of a piece, and return h² f sgn θ′."""
    friction_limit = step * step * plant[COULOMB]
    if friction_limit == 0.0:
        return 0.0
    state[MODE] = MOVING
    if state[RATE] != 0.0:
        return math.copysign(friction_limit, state[RATE])
    load_torque = torque(load[0], plant, state)
    if slipping or abs(load_torque) > friction_limit:
        return math.copysign(friction_limit, load_torque)
    state[MODE] = STUCK
    return 0.0


@kernel
def _time_to_friction_change(
    load: NDArray[np.float64],
    step: float,
    plant: NDArray[np.float64],
    state: NDArray[np.float64],
    remaining: float,
    work: NDArray[np.float64],
) -> float:
    """Return when a sliding rod comes to rest, or a stuck one breaks loose."""
    angle = work[ANGLE_SERIES]
    if state[MODE] == STUCK:
        friction_limit = step * step * plant[COULOMB]
        reserve = work[EVENT, : load.size]
        torque_of_load = torque(1.0, plant, state)
        soonest = NEVER
        for factor in (-torque_of_load, torque_of_load):
            for n in range(load.size):
                reserve[n] = factor * load[n]
            reserve[0] = max(reserve[0] + friction_limit, 0.0)
            soonest = min(soonest, first_descent(reserve, remaining, work[ROOM:]))
        return soonest
    slope = work[EVENT, :-1]
    first = 1
    while angle[first] == 0.0 and first < angle.size - 1:
        first += 1
    direction = math.copysign(1.0, angle[first])
    for n in range(slope.size):
        slope[n] = direction * (n + 1) * angle[n + 1]
    return first_descent(slope, remaining, work[ROOM:])


@kernel
def _time_to_stop(stop: float, remaining: float, work: NDArray[np.float64]) -> float:
    angle, room_left = work[ANGLE_SERIES], work[EVENT]
    bound = 0.0
    for n in range(angle.size):
        bound += abs(angle[n])
    if bound < stop:
        return NEVER
    soonest = NEVER
    for side in (-1.0, 1.0):
        for n in range(angle.size):
            room_left[n] = side * angle[n]
        room_left[0] += stop
        soonest = min(soonest, first_descent(room_left, remaining, work[ROOM:]))
    return soonest


@kernel
def _rest_at_stop(state: NDArray[np.float64], plant: NDArray[np.float64]) -> None:
    state[ANGLE] = math.copysign(plant[STOP], state[ANGLE])
    state[RATE] = 0.0
    state[MODE] = FALLEN
