# ruff: noqa: PLR0917 (compiled functions take their arrays by position)
"""Play at the pivot: the hole rests on the pin, flies free of it and strikes it again.

The pin's motion is prescribed. The hole's centre stays within ±D/2 of it; in contact it shares the pin's acceleration,
in flight it falls freely, and an impact changes its velocity by −(1 + e) times the relative one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kapitsa_ros.physics.kernels.jit import kernel
from kapitsa_ros.physics.kernels.layout import (
    ANGLE,
    CLEARANCE,
    CONTACT,
    FAILED,
    FAILURE_CLEARANCE,
    GAP,
    GAP_RATE,
    IMPACT_ENERGY,
    IN_FLIGHT,
    LINEAR,
    MODE,
    RATE,
    RESTITUTION,
    WEAR,
    K,
)
from kapitsa_ros.physics.kernels.roots import NEVER, first_descent

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

SMALLEST_BOUNCE = 1e-12  # of the clearance: the last impact of a bouncing hole takes all the velocity that remains


@kernel
def expand_gap(
    load: NDArray[np.float64],
    step: float,
    state: NDArray[np.float64],
    lifting: bool,  # noqa: FBT001
    gap: NDArray[np.float64],
) -> None:
    """Settle whether the hole rests on the pin as a piece begins, and fill `gap` with the series of its offset."""
    if state[CONTACT] != IN_FLIGHT and state[CONTACT] * load[0] > 0.0:
        state[CONTACT] = IN_FLIGHT
    if state[CONTACT] != IN_FLIGHT:
        return
    gap[0] = state[GAP]
    gap[1] = step * state[GAP_RATE]
    for n in range(load.size):
        gap[n + 2] = -load[n] / ((n + 1) * (n + 2))
    if lifting:  # the load is zero here but for its last bit
        gap[2] = 0.0


@kernel
def time_to_touch(
    load: NDArray[np.float64],
    gap: NDArray[np.float64],
    state: NDArray[np.float64],
    remaining: float,
    event: NDArray[np.float64],
    room: NDArray[np.float64],
) -> float:
    """Return when the hole lifts off the pin, or strikes it."""
    if state[CONTACT] != IN_FLIGHT:
        for n in range(load.size):
            event[n] = -state[CONTACT] * load[n]
        return first_descent(event[: load.size], remaining, room)
    soonest = NEVER
    for side in (-1.0, 1.0):
        for n in range(gap.size):
            event[n] = side * gap[n]
        event[0] += 0.5 * state[CLEARANCE]
        soonest = min(soonest, first_descent(event[: gap.size], remaining, room))
    return soonest


@kernel
def touch(
    load: NDArray[np.float64],
    step: float,
    plant: NDArray[np.float64],
    state: NDArray[np.float64],
) -> None:
    """Lift the hole off the pin, or carry out its impact, which changes the rate of the rod and wears the hole."""
    if state[CONTACT] != IN_FLIGHT:
        state[CONTACT] = IN_FLIGHT
        state[GAP_RATE] = 0.0
        return
    side = math.copysign(1.0, state[GAP])
    approach = state[GAP_RATE]
    rebound = plant[RESTITUTION] * approach
    acceleration = -side * load[0] / (step * step)
    if acceleration > 0.0 and rebound**2 <= 2.0 * acceleration * SMALLEST_BOUNCE * state[CLEARANCE]:
        rebound = 0.0
        state[CONTACT] = side
    sin_theta = state[ANGLE] if plant[LINEAR] != 0.0 else math.sin(state[ANGLE])
    state[RATE] -= (approach + rebound) * plant[K] * sin_theta
    state[GAP_RATE] = -rebound

    energy = 0.5 * (approach * approach - rebound * rebound)
    state[IMPACT_ENERGY] += energy
    state[CLEARANCE] += plant[WEAR] * energy
    if state[CLEARANCE] >= plant[FAILURE_CLEARANCE]:
        state[MODE] = FAILED
    state[GAP] = side * 0.5 * state[CLEARANCE]
