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
from kapitsa_ros.physics.kernels.roots import NEVER, first_descent
from kapitsa_ros.physics.kernels.series import expand, shift, value_and_slope

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MOST_PIECES = 10_000
WORK_ROWS = 7


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
        Shape (WORK_ROWS, order + 1): room for the series of θ, sin θ, cos θ, θ̇, drive, gap and load.

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
    angle = work[0]
    _expand_angle(load, 0.0, step, plant, state, work)
    change, slope, bound = 0.0, 0.0, abs(angle[0])
    for n in range(angle.size - 1, 0, -1):
        change += angle[n]
        slope += n * angle[n]
        bound += abs(angle[n])
    if bound >= plant[STOP] and _time_to_stop(angle, plant[STOP], 1.0) <= 1.0:
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
    angle, gap = work[0], work[5, : load.size + 2]
    work[6, : load.size] = load
    load = work[6, : load.size]
    if start > 0.0:
        shift(load, start)
    remaining = 1.0 - start
    slipping, lifting = False, False
    for _ in range(MOST_PIECES):
        expand_gap(load, step, state, lifting, gap)
        _expand_piece(load, step, plant, state, work, slipping)
        stop = _time_to_stop(angle, plant[STOP], remaining)
        change = _time_to_friction_change(load, angle, step, plant, state, remaining, work[3, 1:])
        contact = time_to_touch(load, gap, state, remaining)
        span = min(stop, change, contact, remaining)
        _carry(angle, gap, span, step, state)
        if span == remaining:
            return True
        shift(load, span)
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
    angle = work[0]
    if state[MODE] == STUCK:
        angle[:] = 0.0
        angle[0] = state[ANGLE]
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
    drive = work[4, :-2]
    k = 0.0 if state[CONTACT] == IN_FLIGHT else plant[K]
    for n in range(load.size):
        drive[n] = k * load[n]
    drive[load.size :] = 0.0
    angle = work[0]
    angle[0] = state[ANGLE]
    angle[1] = step * state[RATE]
    expand(drive, step * plant[DAMPING], friction, plant[LINEAR] != 0.0, angle, work[1], work[2], work[3])


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
    angle: NDArray[np.float64],
    step: float,
    plant: NDArray[np.float64],
    state: NDArray[np.float64],
    remaining: float,
    slope: NDArray[np.float64],
) -> float:
    """Return when a sliding rod comes to rest, or a stuck one breaks loose."""
    friction_limit = step * step * plant[COULOMB]
    if friction_limit == 0.0:
        return NEVER
    if state[MODE] == STUCK:
        load_torque = load * torque(1.0, plant, state)
        ahead, behind = -load_torque, load_torque
        ahead[0] = max(ahead[0] + friction_limit, 0.0)
        behind[0] = max(behind[0] + friction_limit, 0.0)
        return min(first_descent(ahead, remaining), first_descent(behind, remaining))
    first = 1
    while angle[first] == 0.0 and first < angle.size - 1:
        first += 1
    direction = math.copysign(1.0, angle[first])
    for n in range(slope.size):
        slope[n] = direction * (n + 1) * angle[n + 1]
    return first_descent(slope, remaining)


@kernel
def _time_to_stop(angle: NDArray[np.float64], stop: float, remaining: float) -> float:
    bound = 0.0
    for n in range(angle.size):
        bound += abs(angle[n])
    if bound < stop:
        return NEVER
    ahead = -angle
    ahead[0] += stop
    behind = angle.copy()
    behind[0] += stop
    return min(first_descent(ahead, remaining), first_descent(behind, remaining))


@kernel
def _rest_at_stop(state: NDArray[np.float64], plant: NDArray[np.float64]) -> None:
    state[ANGLE] = math.copysign(plant[STOP], state[ANGLE])
    state[RATE] = 0.0
    state[MODE] = FALLEN
