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
_GROWTH = 30.0  # ln of how much wider than at its release a swing gets at most, where damping is below 0
_BARRIER = 1e-3  # share of the small swing's stiffness that is left to a swing at the barrier
_PHASES = np.sin((np.arange(4) + 0.5) * math.pi / 8.0)  # midpoints: the integrand is periodic and smooth
WORK_ROWS = 5
_NODES = 0.5 * (np.polynomial.legendre.leggauss(2)[0] + 1.0)  # of the time of a timing, equally weighted


@kernel
def small_swings_at(k: Array, amplitude: Array, damping: Array, speed: Array, gravity: float, slow: Array) -> None:
    """Fill in Ω of small swings, rad/s, of M rods at a speed each: arrays of shape (M,).

    By the power series of Mathieu's characteristic value (DLMF 28.15.1). The loop has no call and no branch, so that
    processors do several rods at once.
    """
    for i in range(slow.size):
        reach = k[i] * amplitude[i]
        q2 = 4.0 * reach * reach
        q4 = q2 * q2 / 32.0
        decay = damping[i] / speed[i]
        goal = -4.0 * k[i] * gravity / (speed[i] * speed[i]) - decay * decay
        nu2 = min(max(goal + 0.5 * q2, 0.0), 0.5)
        for _ in range(_ITERATIONS):
            near, far = nu2 - 1.0, nu2 - 4.0
            nu2 = goal - q2 / (2.0 * near) - (5.0 * nu2 + 7.0) * q4 / (near * near * near * far)
            nu2 = min(max(nu2, -0.5), 0.5)
        slow[i] = 0.5 * speed[i] * math.sqrt(max(nu2, _NO_SWING))


@kernel
def small_swings(
    k: Array, amplitude: Array, damping: Array, speed: Array, gravity: float, slow: Array, work: Array
) -> None:
    """Fill in Ω of M rods, rad/s, at N speeds each; `slow` has the shape (M, N), `speed` that or (1, N).

    `work` is work space, shape (WORK_ROWS, M).
    """
    forcing, found = work[0], work[1]
    for run in range(slow.shape[1]):
        for rod in range(k.size):
            forcing[rod] = speed[min(rod, speed.shape[0] - 1), run]
        small_swings_at(k, amplitude, damping, forcing, gravity, found)
        for rod in range(k.size):
            slow[rod, run] = found[rod]


@kernel
def friction_factor(ratio: float, factors: Array, spacing: float) -> float:
    """Return K(r) from its table at even distances, from 0 on."""
    place = ratio / spacing
    index = int(place)
    if index >= factors.size - 1:
        return float(factors[-1])
    return float(factors[index] + (place - index) * (factors[index + 1] - factors[index]))


@kernel
def widths_after(
    k: Array,
    amplitude: Array,
    damping: Array,
    slow: Array,
    loss: Array,
    release: float,
    periods: float,
    width: Array,
) -> None:
    """Fill in widths some periods after a release, rad: A′ = −cA/2 − (friction's loss), and 0 at the end."""
    for rod in range(width.size):
        start = release / (1.0 - min(k[rod] * amplitude[rod], 0.9))  # at the bottom of the stroke (report, eq. 12)
        decay = max(damping[rod] * math.pi / slow[rod] * periods, -_GROWTH)
        mean = -math.expm1(-decay) / decay if abs(decay) > 1e-8 and loss[rod] > 0.0 else 1.0
        width[rod] = max(start * math.exp(-decay) - loss[rod] * periods * mean, 0.0)


@kernel
def soften(k: Array, amplitude: Array, forcing: Array, width: Array, gravity: float, slower: Array) -> None:
    """Add by how much the potential makes swings of some width slower than small ones, once for each phase."""
    for rod in range(slower.size):
        edge = math.sin(0.5 * min(width[rod], _WIDEST))
        swept = k[rod] * amplitude[rod] * forcing[rod]
        stiffness = 0.5 * swept * swept
        weight = k[rod] * gravity
        linear = max(stiffness - weight, 1e-6)
        total = slower[rod]
        for phase in _PHASES:
            half = edge * phase
            left = max(stiffness * (1.0 - edge * edge - half * half) - weight, _BARRIER * linear)
            total += math.sqrt(linear / (left * (1.0 - half * half)))
        slower[rod] = total


@kernel
def period_errors(reach: Array, of_speed: Array, variance: Array, period: Array, doubt: Array, sigma: Array) -> None:
    """Fill in the standard uncertainty of each period, s, shape (M, N).

    Parameters
    ----------
    reach
        kλ of the rods, shape (M,).
    of_speed
        Relative error of a period by that of the speed, for kλ = 1, shape (N,).
    variance, period
        Relative variance of a period by all that is the same for all rods, and the period, s: shape (N,).
    doubt
        How far the model can be trusted, relative, shape (M, N).
    sigma
        Shape (M, N).

    """
    for rod in range(sigma.shape[0]):
        square = reach[rod] * reach[rod]
        for run in range(sigma.shape[1]):
            by_speed, by_model = square * of_speed[run], doubt[rod, run]
            sigma[rod, run] = period[run] * math.sqrt(variance[run] + by_speed * by_speed + by_model * by_model)


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
    work: Array,
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
    work
        Work space, shape (WORK_ROWS, M).

    """
    rods, runs = period.shape
    forcing, slow, loss, width, slower = work[0], work[1], work[2], work[3], work[4]
    for run in range(runs):
        for rod in range(rods):
            forcing[rod] = speed[min(rod, speed.shape[0] - 1), run]
            slower[rod] = 0.0
        small_swings_at(k, amplitude, damping, forcing, gravity, slow)
        for rod in range(rods):
            loss[rod] = 0.0
            if coulomb[rod] > 0.0:
                ratio = slow[rod] / (k[rod] * amplitude[rod] * forcing[rod])
                loss[rod] = coulomb[rod] * friction_factor(ratio, factors, spacing) / (slow[rod] * slow[rod])
        for node in _NODES:
            widths_after(k, amplitude, damping, slow, loss, release[run], FIRST_PRESS + node * swings[run], width)
            soften(k, amplitude, forcing, width, gravity, slower)
        widths_after(k, amplitude, damping, slow, loss, release[run], FIRST_PRESS + 0.5 * swings[run], width)
        for rod in range(rods):
            softened = slower[rod] / (_NODES.size * _PHASES.size)
            period[rod, run] = 2.0 * math.pi / slow[rod] * softened
            doubt[rod, run] = 0.3 * (softened - 1.0) ** 2
            if loss[rod] > 0.0:  # smooth: a fit ends in the kinks that there are
                square = loss[rod] * loss[rod]
                eaten = square / (width[rod] * width[rod] + square)
                doubt[rod, run] = math.hypot(doubt[rod, run], 0.1 * eaten)
