# ruff: noqa: PLR0917 (compiled functions take their arrays by position)
"""Periods of slow swings that narrow while they are timed, of many rods at many speeds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.kernels.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

FIRST_PRESS = 0.75
"""Periods from the release to the first press: the second passage through upright."""

_ITERATIONS = 5  # of ν², each of which makes it some 100 times better
_NO_SWING = 1e-10  # ν² that stands for no slow frequency at all
_WIDEST = 1.4  # rad
_BARRIER = 1e-3  # share of the small swing's stiffness that is left to a swing at the barrier
_PHASES = np.sin((np.arange(4) + 0.5) * math.pi / 8.0)  # midpoints: the integrand is periodic and smooth
_NODES = 0.5 * (np.polynomial.legendre.leggauss(2)[0] + 1.0)  # of the time of a timing, equally weighted


@kernel
def small_swing(k: float, reach: float, damping: float, speed: float, gravity: float) -> float:
    """Return Ω of a small swing, rad/s, by the power series of Mathieu's characteristic value (DLMF 28.15.1)."""
    q2 = (2.0 * reach) ** 2
    q4 = q2 * q2 / 32.0
    goal = -4.0 * k * gravity / speed**2 - (damping / speed) ** 2
    nu2 = min(max(goal + 0.5 * q2, 0.0), 0.5)
    for _ in range(_ITERATIONS):
        near, far = nu2 - 1.0, nu2 - 4.0
        nu2 = goal - q2 / (2.0 * near) - (5.0 * nu2 + 7.0) * q4 / (near * near * near * far)
        nu2 = min(max(nu2, -0.5), 0.5)
    return 0.5 * speed * math.sqrt(max(nu2, _NO_SWING))


@kernel
def small_swings(k: Array, amplitude: Array, damping: Array, speed: Array, gravity: float, slow: Array) -> None:
    """Fill in Ω of M rods, rad/s, at N speeds each; `slow` has the shape (M, N), `speed` that or (1, N)."""
    for rod in range(slow.shape[0]):
        row = min(rod, speed.shape[0] - 1)
        for run in range(slow.shape[1]):
            reach = k[rod] * amplitude[rod]
            slow[rod, run] = small_swing(k[rod], reach, damping[rod], speed[row, run], gravity)


@kernel
def friction_factor(ratio: float, factors: Array, spacing: float) -> float:
    """Return K(r) from its table at even distances, from 0 on."""
    place = ratio / spacing
    index = int(place)
    if index >= factors.size - 1:
        return float(factors[-1])
    return float(factors[index] + (place - index) * (factors[index + 1] - factors[index]))


@kernel
def width_after(start: float, loss: float, damping: float, slow: float, periods: float) -> float:
    """Return the width after some periods, rad: A′ = −cA/2 − (friction's loss), and 0 at the end."""
    decay = damping * math.pi / slow * periods
    mean = -math.expm1(-decay) / decay if decay > 1e-8 else 1.0
    return max(start * math.exp(-decay) - loss * periods * mean, 0.0)


@kernel
def slow_periods(
    k: Array,
    amplitude: Array,
    damping: Array,
    coulomb: Array,
    speed: Array,
    release: Array,
    swings: Array,
    gravity: float,
    factors: Array,
    spacing: float,
    period: Array,
    doubt: Array,
) -> None:
    """Fill in what a stopwatch would show per swing, s, and how far that can be trusted, relative.

    Parameters
    ----------
    k, amplitude, damping, coulomb
        m·l_c/I, 1/m; λ, m; c, 1/s; f, rad/s²: shape (M,).
    speed
        ω, rad/s, shape (M, N), or (1, N) where it is the same for all rods.
    release, swings
        |θ| at the release, rad, and full swings that are timed, shape (N,).
    gravity
        m/s².
    factors, spacing
        Table of K(r), see `friction_factor`.
    period, doubt
        Shape (M, N).

    """
    for rod in range(period.shape[0]):
        reach = k[rod] * amplitude[rod]
        weight = k[rod] * gravity
        still = 1.0 - min(reach, 0.9)
        row = min(rod, speed.shape[0] - 1)
        for run in range(period.shape[1]):
            forcing = speed[row, run]
            slow = small_swing(k[rod], reach, damping[rod], forcing, gravity)
            loss = coulomb[rod] * friction_factor(slow / (reach * forcing), factors, spacing) / slow**2
            start = release[run] / still  # let go at the bottom of the stroke (report, eq. 12)
            stiffness = 0.5 * (reach * forcing) ** 2
            linear = max(stiffness - weight, 1e-6)
            slower = 0.0
            for node in _NODES:
                width = width_after(start, loss, damping[rod], slow, FIRST_PRESS + node * swings[run])
                edge = math.sin(0.5 * min(width, _WIDEST))
                for phase in _PHASES:
                    half = edge * phase
                    left = max(stiffness * (1.0 - edge * edge - half * half) - weight, _BARRIER * linear)
                    slower += math.sqrt(linear / (left * (1.0 - half * half)))
            slower /= _NODES.size * _PHASES.size
            middle = max(width_after(start, loss, damping[rod], slow, FIRST_PRESS + 0.5 * swings[run]), loss)
            eaten = loss / middle if loss > 0.0 else 0.0
            period[rod, run] = 2.0 * math.pi / slow * slower
            doubt[rod, run] = math.hypot(0.3 * (slower - 1.0) ** 2, 0.1 * eaten * eaten)
