# ruff: noqa: PLR0917 (compiled functions take their arrays by position)
"""Interpolation of a sampled motion by its values, rates and accelerations.

Through m neighbouring samples with all three there is one polynomial of degree 3m − 1 (Hermite); with m = 4 its second
derivative keeps tenth order, so 1 kHz is enough for a shaft at 4000 RPM.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from math import perm
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.kernels.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

STENCIL = 4


@cache
def stencil_weights(points: int) -> NDArray[np.float64]:
    """Return what turns samples into the series of their acceleration, computed in rational arithmetic.

    Parameters
    ----------
    points
        m, samples in a stencil.

    Returns
    -------
    ndarray, shape (m − 1, 3m − 2, 3m)
        For the interval that starts at each sample of the stencil: coefficients of h² y″(τ) from
        (y, h y′, h² y″) of its m samples in turn.

    """
    weights = np.empty((points - 1, 3 * points - 2, 3 * points))
    for interval in range(points - 1):
        inverse = _inverse([_row(point - interval, order, 3 * points) for point in range(points) for order in range(3)])
        for power in range(3 * points - 2):
            factor = (power + 1) * (power + 2)
            weights[interval, power] = [float(factor * entry) for entry in inverse[power + 2]]
    return weights


def _row(at: int, order: int, size: int) -> list[int]:
    """Return the derivatives of the given order of 1, τ, τ², … at an integer τ."""
    return [perm(n, order) * at ** (n - order) if n >= order else 0 for n in range(size)]


def _inverse(matrix: list[list[int]]) -> list[list[Fraction]]:
    """Return the inverse of a matrix of integers, which stay integers on the way (Bareiss 1968): ten times as fast."""
    size = len(matrix)
    rows = [[*row, *(int(i == j) for j in range(size))] for i, row in enumerate(matrix)]
    last = 1
    for column in range(size):
        pivot = next(i for i in range(column, size) if rows[i][column])
        rows[column], rows[pivot] = rows[pivot], rows[column]
        head, top = rows[column], rows[column][column]
        for i, row in enumerate(rows):
            if i != column:
                rows[i] = [(top * entry - row[column] * other) // last for entry, other in zip(row, head, strict=True)]
        last = top
    return [[Fraction(entry, last) for entry in row[size:]] for row in rows]


@kernel
def acceleration_series(
    weights: NDArray[np.float64],
    period: float,
    position: NDArray[np.float64],
    rate: NDArray[np.float64],
    acceleration: NDArray[np.float64],
    series: NDArray[np.float64],
) -> None:
    """Fill `series` (one row an interval) with the coefficients of h² y″(τ); stencils stay within the block."""
    points = weights.shape[0] + 1
    last_first = position.size - points
    square = period * period
    for i in range(position.size - 1):
        first = min(max(i - (points // 2 - 1), 0), last_first)
        rule = weights[i - first]
        for power in range(series.shape[1]):
            total = 0.0
            for point in range(points):
                at = first + point
                total += rule[power, 3 * point] * (position[at] - position[i])
                total += rule[power, 3 * point + 1] * (period * rate[at])
                total += rule[power, 3 * point + 2] * (square * acceleration[at])
            series[i, power] = total
