"""How the rod's state and constants lie in the arrays that kernels take."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.physics.plant import Plant

# The state; rates per second.
ANGLE, RATE, MODE, GAP, GAP_RATE, CONTACT, CLEARANCE, IMPACT_ENERGY, RELEASING = range(9)
STATE_SIZE = 9

# MODE: what the rod does.
HELD, MOVING, STUCK, FALLEN, FAILED = 0.0, 1.0, 2.0, 3.0, 4.0

# CONTACT: the sign of GAP, the hole's centre above the pin's, where they touch (+1: the pin pulls down).
PIN_PUSHES_UP, IN_FLIGHT = -1.0, 0.0

# The constants.
K, GRAVITY, DAMPING, COULOMB, RESTITUTION, STOP, WEAR, FAILURE_CLEARANCE, LINEAR = range(9)


def constants(plant: Plant, *, stop: float, linear: bool) -> NDArray[np.float64]:
    """Lay out the constants of a plant."""
    return np.array(
        [
            plant.k,
            plant.gravity,
            plant.damping,
            plant.coulomb,
            plant.restitution,
            stop,
            plant.wear,
            plant.failure_clearance,
            float(linear),
        ],
    )


def state_at_rest(angle: float, clearance: float) -> NDArray[np.float64]:
    """Lay out the state of a rod that is held at an angle, its hole hanging on the pin."""
    state = np.zeros(STATE_SIZE)
    state[ANGLE] = angle
    state[MODE] = HELD
    state[CONTACT] = PIN_PUSHES_UP
    state[CLEARANCE] = clearance
    state[GAP] = -0.5 * clearance
    return state
