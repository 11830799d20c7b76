# ruff: noqa: PLR0917 (compiled functions take their arrays by position)
"""A rod that bends: power series of its angle and of one bending mode."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kapitsa_ros.physics.kernels.cosine import at_phase, fill_drive_terms, fill_load
from kapitsa_ros.physics.kernels.jit import kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ORDER = 18
WORK_SHAPE = (15, ORDER + 1)
J, L_C, BETA, G, C, OMEGA_B, ZETA = range(7)


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
    work: NDArray[np.float64],
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
    work
        Work space, of WORK_SHAPE.

    Returns
    -------
    float
        The largest last term met, rad.

    """
    turns = speed * step / (2.0 * math.pi)
    load, drive_terms, state = work[12, :ORDER], work[13, :ORDER], work[14, :4]
    fill_drive_terms(amplitude, speed, step, turns, drive_terms)
    work[:12] = 0.0
    theta, eta = work[0], work[1]
    for row in range(4):
        state[row] = motion[row, 0]
    truncation = 0.0
    for sample in range(1, motion.shape[1]):
        if abs(state[0]) < stop:
            for i in range((sample - 1) * stride, sample * stride):
                cosine, sine = at_phase(i * turns, start)
                fill_load(cosine, sine, drive_terms, step * step * rod[G], load)
                theta[0], theta[1], eta[0], eta[1] = state[0], step * state[1], state[2], step * state[3]
                _expand(load, step, rod, work[:12])
                state[0], state[1] = _end(theta, step)
                state[2], state[3] = _end(eta, step)
                truncation = max(truncation, abs(theta[-1]))
        for row in range(4):
            motion[row, sample] = state[row]
    return truncation


@kernel
def _expand(load: NDArray[np.float64], step: float, rod: NDArray[np.float64], work: NDArray[np.float64]) -> None:
    """Fill the series of θ and η from their first two terms.

    Momentum p = (J + η²)θ̇ keeps the equations free of θ̈: ṗ = (g + ÿ)(l_c sin θ + βη cos θ) − Jcθ̇ and
    η̈ = ηθ̇² + β(g + ÿ) sin θ − ω_b²η − 2ζω_b η̇.
    """
    theta, eta, theta_dot, eta_dot, sine, cosine, inertia, momentum, lever, square, load_sine, _ = work
    stiffness = (step * rod[OMEGA_B]) ** 2
    damping = 2.0 * rod[ZETA] * step * rod[OMEGA_B]
    friction = step * rod[C] * rod[J]
    sine[0], cosine[0] = math.sin(theta[0]), math.cos(theta[0])
    inertia[0] = rod[J] + eta[0] ** 2
    momentum[0] = inertia[0] * theta[1]
    eta_dot[0] = eta[1]
    for n in range(ORDER):
        if n > 0:
            sine[n] = _chain(theta, cosine, n) / n
            cosine[n] = -_chain(theta, sine, n) / n
            inertia[n] = _product(eta, eta, n)
        rest = momentum[n]
        for j in range(1, n + 1):
            rest -= inertia[j] * theta_dot[n - j]
        theta_dot[n] = rest / inertia[0]
        theta[n + 1] = theta_dot[n] / (n + 1)
        eta[n + 1] = eta_dot[n] / (n + 1)
        lever[n] = rod[L_C] * sine[n] + rod[BETA] * _product(eta, cosine, n)
        square[n] = _product(theta_dot, theta_dot, n)
        load_sine[n] = _product(load, sine, n)
        momentum[n + 1] = (_product(load, lever, n) - friction * theta_dot[n]) / (n + 1)
        forcing = _product(eta, square, n) + rod[BETA] * load_sine[n]
        eta_dot[n + 1] = (forcing - stiffness * eta[n] - damping * eta_dot[n]) / (n + 1)


@kernel
def _product(left: NDArray[np.float64], right: NDArray[np.float64], n: int) -> float:
    """Return the nth coefficient of a product."""
    total = 0.0
    for j in range(n + 1):
        total += left[j] * right[n - j]
    return total


@kernel
def _chain(theta: NDArray[np.float64], factor: NDArray[np.float64], n: int) -> float:
    """Return the (n − 1)th coefficient of θ̇ times a factor."""
    total = 0.0
    for j in range(1, n + 1):
        total += j * theta[j] * factor[n - j]
    return total


@kernel
def _end(series: NDArray[np.float64], step: float) -> tuple[float, float]:
    """Return a series and its rate per second at the end of the step."""
    value, slope = 0.0, 0.0
    for n in range(series.size - 1, 0, -1):
        value += series[n]
        slope += n * series[n]
    return value + series[0], slope / step
