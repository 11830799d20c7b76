"""The slow motion seen once a turn: a complex amplitude that the linear theory only turns and stretches."""

from __future__ import annotations

import cmath
from typing import TYPE_CHECKING

import numpy as np
import scipy

from kapitsa_ros.physics.theory.mathieu import half_period, mathieu_a, mathieu_q

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.physics.plant import Plant

FEW_SWINGS = 8
_KAISER = 36.0
"""Shape of Kaiser's window: it forgets what oscillates 11.5 times or more, but for 1e-15 of it."""


def slow_amplitude(
    plant: Plant,
    speed: float,
    angle: NDArray[np.float64],
    rate: NDArray[np.float64],
) -> NDArray[np.complex128]:
    """Return the slow motion's complex amplitude from θ and θ′ at the bottoms of the stroke.

    It is the left eigenvector of the monodromy matrix applied to the state: from one turn to the next it is multiplied
    by the Floquet multiplier itself (the larger one where they are real), whatever the damping. Its modulus is that of
    θ where the rod turns round.
    """
    a = mathieu_a(plant, speed) - (plant.damping / speed) ** 2
    x1, r1, x2, r2 = half_period(a, mathieu_q(plant))
    # For w = θ e^(ct/2) over a whole period: [[D, 2 x₂x₂′], [2 x₁x₁′, D]].
    ratio = cmath.sqrt(complex(x2 * r2 / (x1 * r1)))
    spread = 2.0 * x1 * r1 * ratio  # what the multiplier differs by from half the trace
    if spread.imag > 0 or spread.real * (x1 * r2 + r1 * x2) < 0:
        ratio = -ratio
    slope = (rate + 0.5 * plant.damping * angle) * (2.0 / speed)
    return angle + ratio * slope


def mean_turn(amplitude: NDArray[np.complex128], expected: float) -> float:
    """Return the mean angle from one amplitude to the next, rad.

    Each is taken within half a turn of what is expected: where impacts shake the amplitude some steps go backwards.
    """
    return smooth_mean(_turns(amplitude, expected))


def mean_turn_of_few(amplitude: NDArray[np.complex128], expected: float) -> float:
    """Return what `mean_turn` does, of `FEW_SWINGS` in which all that oscillates does so twice a swing or faster."""
    turns = _turns(amplitude, expected)
    place = np.linspace(-1.0, 1.0, turns.size)
    argument = _KAISER * np.sqrt(1.0 - place**2)
    weight = scipy.special.i0e(argument) * np.exp(argument - _KAISER)
    return float(weight @ turns / weight.sum())


def _turns(amplitude: NDArray[np.complex128], expected: float) -> NDArray[np.float64]:
    steps = np.angle(amplitude[:-1] / amplitude[1:])
    return np.asarray(expected + np.mod(steps - expected + np.pi, 2.0 * np.pi) - np.pi)


def mean_growth(amplitude: NDArray[np.complex128]) -> float:
    """Return the mean growth of ln |amplitude| from one to the next."""
    steps = np.diff(np.log(np.abs(amplitude)))
    return smooth_mean(steps)


def smooth_mean(values: NDArray[np.float64]) -> float:
    """Return a mean that forgets oscillations faster than any power of how many values there are."""
    return float(_bump(values.size) @ values)


def _bump(count: int) -> NDArray[np.float64]:
    """Return weights exp(−1/(t(1 − t))) at `count` times in (0, 1), summing to 1.

    An average with them forgets every oscillation faster than any power of their number (Das, Saiki, Sander & Yorke,
    Nonlinearity 30 (2017) 4111).
    """
    time = (np.arange(count) + 1.0) / (count + 1.0)
    weight = np.exp(-1.0 / (time * (1.0 - time)))
    return np.asarray(weight / weight.sum())
