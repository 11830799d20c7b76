"""Play at the pivot: the hole overshoots the pin, so play stiffens the slow motion and lowers the threshold."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import scipy

from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.kernels import layout
from kapitsa_ros.physics.kernels.cosine import TOO_MANY_EVENTS, WORK_SHAPE, advance_cosine
from kapitsa_ros.physics.step_size import steps_per_turn
from kapitsa_ros.physics.theory.floquet import omega_crit_exact, slow_frequency_exact

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.physics.plant import Plant

_SETTLING = 64  # turns after which impacts that lose energy repeat themselves, if they ever do
_LONGEST_CYCLE = 16  # turns
_SHAKEN = 256  # turns over which the growth is averaged where impacts never repeat
_SAME = 1e-9  # of the clearance
_REACH = 0.8, 1.1  # of the first-order threshold: it is 6 % low at a play of 5 mm


def effective_amplitude(plant: Plant) -> float:
    """Return λ_eff ≈ λ (1 + (2/π) D/λ), m: first order in D/λ, plastic impacts (e = 0), λω² ≫ g."""
    return plant.amplitude + 2.0 / math.pi * plant.clearance


def play_amplitude_ratio(ratio: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return λ_eff/λ for a play of D = `ratio` · λ, beyond first order: what harmonic motion would hold a rod up alike.

    Between strokes the hole flies on at the pin's fastest, over an angle α of the crank with α − sin α = D/λ, and
    ⟨y′²⟩ is what holds the rod up: λ_eff² = λ² (1 + (2/π)(α/2 − sin 2α/4)), for plastic impacts and λω² ≫ g. To first
    order λ_eff = λ + (2/π) D; at a play of 2 mm the threshold is good to 0.1 %.
    """
    found = np.ones_like(ratio)
    has_play = ratio > 0.0
    play = np.minimum(ratio[has_play], 1.0)
    angle = np.cbrt(6.0 * play)
    for _ in range(4):
        angle -= (angle - np.sin(angle) - play) / np.maximum(1.0 - np.cos(angle), 1e-12)
    found[has_play] = np.sqrt(1.0 + 2.0 / math.pi * (0.5 * angle - 0.25 * np.sin(2.0 * angle)))
    return found


def slow_frequency_with_play(plant: Plant, speed: float) -> float | None:
    """Return Ω, rad/s: the exact linear value at the effective amplitude."""
    return slow_frequency_exact(replace(plant, amplitude=effective_amplitude(plant)), speed)


def omega_crit_with_play(plant: Plant) -> float:
    """Return the speed from which the upright rod is stable, rad/s: Floquet's theory under the motion of the hole.

    The hole's motion does not hang on that of the rod, so the equation of small angles stays linear: the torque is that
    of the pin in contact, none in flight, and a blow at an impact. A multiplier leaves +1 inwards. Where impacts never
    repeat themselves the growth is a mean over many turns.

    Parameters
    ----------
    plant
        Its Coulomb friction and its wear do not enter.

    Raises
    ------
    PhysicsError
        Impacts are too close together to be resolved, or there is no threshold near that of first order.

    """
    if plant.clearance == 0.0:
        return omega_crit_exact(plant)
    first_order = omega_crit_exact(replace(plant, amplitude=effective_amplitude(plant)))
    low, high = (reach * first_order for reach in _REACH)
    if _excess(plant, low) <= 0.0 or _excess(plant, high) >= 0.0:
        raise PhysicsError(f'clearance of {plant.clearance:g} m: no threshold near {first_order:.4g} rad/s')
    return float(scipy.optimize.brentq(lambda speed: _excess(plant, speed), low, high, xtol=1e-12 * first_order))


def _excess(plant: Plant, speed: float) -> float:
    """Return by how much the trace of the monodromy exceeds what it has where a multiplier is +1.

    With multipliers μ₁μ₂ = d = e^(−cT), one of them is 1 where their sum is 1 + d.
    """
    turn = _Turn(plant, speed)
    settled = turn.after(_SETTLING, layout.state_at_rest(0.0, plant.clearance))
    cycle = turn.cycle(settled)
    columns = []
    for unit in ((1.0, 0.0), (0.0, speed)):
        state = settled.copy()
        state[layout.ANGLE], state[layout.RATE] = 1e-6 * unit[0], 1e-6 * unit[1]
        end = turn.after(cycle, state)
        columns.append((1e6 * end[layout.ANGLE], 1e6 * end[layout.RATE] / speed))
    trace = float(columns[0][0] + columns[1][1])
    return trace - 1.0 - math.exp(-plant.damping * cycle * 2.0 * math.pi / speed)


class _Turn:
    """The linear rod, carried through whole turns of the shaft."""

    def __init__(self, plant: Plant, speed: float) -> None:
        self._amplitude, self._speed, self._clearance = plant.amplitude, speed, plant.clearance
        self._stride = steps_per_turn(plant, speed)
        self._constants = layout.constants(replace(plant, coulomb=0.0, wear=0.0), stop=0.5 * math.pi, linear=True)

    def after(self, turns: int, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the state after a number of turns."""
        state = state.copy()
        state[layout.MODE] = layout.MOVING
        pacing = (2.0 * math.pi / self._speed / self._stride, 1.0 / self._stride, self._stride)
        motion = np.empty((2, turns + 1))
        truncation = advance_cosine(
            self._amplitude, self._speed, 0.0, *pacing, self._constants, state, motion, np.empty(WORK_SHAPE)
        )
        if truncation == TOO_MANY_EVENTS:
            raise PhysicsError('impacts at the pivot are too close together to be resolved: reduce restitution')
        return state

    def cycle(self, state: NDArray[np.float64]) -> int:
        """Return after how many turns the hole is where it was; many, where it does not come back."""
        later = state
        for turns in range(1, _LONGEST_CYCLE + 1):
            later = self.after(1, later)
            hole = np.abs(later - state)[[layout.GAP, layout.CONTACT]]
            rate = abs(later[layout.GAP_RATE] - state[layout.GAP_RATE]) / self._speed
            if max(hole[0], rate) <= _SAME * self._clearance and hole[1] == 0.0:
                return turns
        return _SHAKEN
