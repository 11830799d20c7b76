# ruff: noqa: PLR0917 (compiled functions take their arrays by position)
"""A rod that bends: power series of its angle and of one bending mode."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.kernels.cosine import at_phase, fill_drive_terms, fill_load
from kapitsa_ros.physics.kernels.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

ORDER = 18
J, LEVER, COUPLING, GRAVITY, DAMPING, BENDING, BENDING_DAMPING = range(7)


@kernel
def advance_flexible(
    amplitude: float,
    speed: float,
    start: float,
    step: float,
    stride: int,
    stop: float,
    rod: NDArray[np.float64],
    motion: NDArray[np.float64],
) -> float:
    """Carry θ, θ′, η, η′ through samples that are `stride` steps apart, until the rod reaches its stop.

    Parameters
    ----------
    amplitude, speed, start, step, stride
        As of `cosine.advance_cosine`.
    stop
        |θ| at which the rod has fallen, rad: it is looked for at samples, and the rest of the motion is what it was.
    rod
        J, l_c, β, g, c, ω_b, ζ.
    motion
        Shape (4, samples); the first column on entry, all on return.

    Returns
    -------
    float
        The largest last term met, rad.

    """
    turns = speed * step / (2.0 * math.pi)
    load, rhythm = np.empty(ORDER), np.empty(ORDER)
    fill_drive_terms(amplitude, speed, step, turns, rhythm)
    work = np.zeros((12, ORDER + 1))
    angle, bend = work[0], work[1]
    state = motion[:, 0].copy()
    left_out = 0.0
    for sample in range(1, motion.shape[1]):
        if abs(state[0]) < stop:
            for i in range((sample - 1) * stride, sample * stride):
                cosine, sine = at_phase(i * turns, start)
                fill_load(cosine, sine, rhythm, step * step * rod[GRAVITY], load)
                angle[0], angle[1], bend[0], bend[1] = state[0], step * state[1], state[2], step * state[3]
                _expand(load, step, rod, work)
                state[0], state[1] = _end(angle, step)
                state[2], state[3] = _end(bend, step)
                left_out = max(left_out, abs(angle[-1]))
        motion[:, sample] = state
    return left_out


@kernel
def _expand(load: NDArray[np.float64], step: float, rod: NDArray[np.float64], work: NDArray[np.float64]) -> None:
    """Fill the series of θ and η from their first two terms.

    Momentum p = (J + η²)θ̇ keeps the equations free of θ̈: ṗ = (g + ÿ)(l_c sin θ + βη cos θ) − Jcθ̇ and
    η̈ = ηθ̇² + β(g + ÿ) sin θ − ω_b²η − 2ζω_b η̇.
    """
    angle, bend, pace, sway, sine, cosine, inertia, momentum, lever, square, leaned, _ = work
    stiffness = (step * rod[BENDING]) ** 2
    yielding = 2.0 * rod[BENDING_DAMPING] * step * rod[BENDING]
    friction = step * rod[DAMPING] * rod[J]
    sine[0], cosine[0] = math.sin(angle[0]), math.cos(angle[0])
    inertia[0] = rod[J] + bend[0] ** 2
    momentum[0] = inertia[0] * angle[1]
    sway[0] = bend[1]
    for n in range(ORDER):
        if n > 0:
            sine[n] = _chain(angle, cosine, n) / n
            cosine[n] = -_chain(angle, sine, n) / n
            inertia[n] = _product(bend, bend, n)
        rest = momentum[n]
        for j in range(1, n + 1):
            rest -= inertia[j] * pace[n - j]
        pace[n] = rest / inertia[0]
        angle[n + 1] = pace[n] / (n + 1)
        bend[n + 1] = sway[n] / (n + 1)
        lever[n] = rod[LEVER] * sine[n] + rod[COUPLING] * _product(bend, cosine, n)
        square[n] = _product(pace, pace, n)
        leaned[n] = _product(load, sine, n)
        momentum[n + 1] = (_product(load, lever, n) - friction * pace[n]) / (n + 1)
        whirl = _product(bend, square, n) + rod[COUPLING] * leaned[n]
        sway[n + 1] = (whirl - stiffness * bend[n] - yielding * sway[n]) / (n + 1)


@kernel
def _product(left: NDArray[np.float64], right: NDArray[np.float64], n: int) -> float:
    """Return the nth coefficient of a product."""
    total = 0.0
    for j in range(n + 1):
        total += left[j] * right[n - j]
    return total


@kernel
def _chain(angle: NDArray[np.float64], factor: NDArray[np.float64], n: int) -> float:
    """Return the (n − 1)th coefficient of θ̇ times a factor."""
    total = 0.0
    for j in range(1, n + 1):
        total += j * angle[j] * factor[n - j]
    return total


@kernel
def _end(series: NDArray[np.float64], step: float) -> tuple[float, float]:
    height, pace = 0.0, 0.0
    for n in range(series.size - 1, 0, -1):
        height += series[n]
        pace += n * series[n]
    return height + series[0], pace / step
