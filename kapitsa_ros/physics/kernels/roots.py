"""The first root of a polynomial, with certainty.

In the Bernstein basis of an interval the number of sign changes bounds the number of roots in it and has its parity
(variation diminishing: Lane & Riesenfeld, BIT 21 (1981) 112): none means no root, one means exactly one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.kernels.jit import kernel
from kapitsa_ros.physics.kernels.series import BINOMIAL, shift, value, value_and_slope

if TYPE_CHECKING:
    from numpy.typing import NDArray

NEVER = np.inf
ROOM_ROWS = 3
"""Of the work space: the scaled polynomial, its part in an interval, sums."""
BINOMIAL_COLUMNS = np.ascontiguousarray(BINOMIAL.T)
NARROWEST = 1e-13


@kernel
def first_descent(polynomial: NDArray[np.float64], end: float, room: NDArray[np.float64]) -> float:
    """Return the first τ in (0, end] at which a polynomial that starts positive comes down to zero.

    Leading coefficients that are exactly zero are divided out: a motion leaves behind the event it starts from.

    Parameters
    ----------
    polynomial
        Its coefficients.
    end
        Where to stop looking, above 0.
    room
        Work space, shape (ROOM_ROWS, at least as many as coefficients).

    Returns
    -------
    float
        The root, or `NEVER`.

    """
    lead = 0
    while lead < polynomial.size - 1 and polynomial[lead] == 0.0:
        lead += 1
    lowest = polynomial[lead]
    power = 1.0
    for n in range(lead + 1, polynomial.size):
        power *= end
        lowest += min(power * polynomial[n], 0.0)
    if lowest > 0.0:
        return NEVER
    if polynomial[lead] <= 0.0:
        return 0.0
    size = polynomial.size - lead
    scaled = room[0, :size]
    power = 1.0
    for n in range(size):
        scaled[n] = power * polynomial[lead + n]
        power *= end
    return end * _first_in_unit(scaled, room[1, :size], room[2, :size])


@kernel
def _first_in_unit(polynomial: NDArray[np.float64], local: NDArray[np.float64], sums: NDArray[np.float64]) -> float:
    start, width = 0.0, 1.0
    while start < 1.0:
        for n in range(local.size):
            local[n] = polynomial[n]
        changes = _sign_changes(local, start, width, sums)
        if changes == 0:
            start += width
            width = min(2.0 * width, 1.0 - start)
        elif changes == 1 or width < NARROWEST:
            return _refine(polynomial, start, start + width)
        else:
            width *= 0.5
    return NEVER


@kernel
def _sign_changes(local: NDArray[np.float64], start: float, width: float, sums: NDArray[np.float64]) -> int:
    """Count the sign changes over [start, start + width]; a zero at the right end counts as one. Destroys `local`."""
    degree = local.size - 1
    if start > 0.0:
        shift(local, start, sums)
    scale = 1.0
    for n in range(1, degree + 1):
        scale *= width
        local[n] *= scale / BINOMIAL[degree, n]
    for row in range(degree + 1):
        sums[row] = 0.0
    for n in range(degree + 1):
        coefficient = local[n]
        for row in range(n, degree + 1):
            sums[row] += BINOMIAL_COLUMNS[n, row] * coefficient
    changes = 0
    negative = local[0] < 0.0
    weight = local[0]
    for row in range(1, degree + 1):
        weight = sums[row]
        if weight != 0.0 and (weight < 0.0) != negative:
            changes += 1
            negative = not negative
    if weight == 0.0 and not negative:
        changes += 1
    return changes


@kernel
def _refine(polynomial: NDArray[np.float64], low: float, high: float) -> float:
    """Newton's method kept inside a bracket that bisection would halve."""
    above, below = value(polynomial, low), value(polynomial, high)
    at = low + (high - low) * above / (above - below) if above > 0.0 >= below else 0.5 * (low + high)
    for _ in range(100):
        height, slope = value_and_slope(polynomial, at)
        if height > 0.0:
            low = at
        else:
            high = at
        following = at - height / slope if slope != 0.0 else low
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - at) <= 2e-16 * max(1e-3, abs(at)) or following in (low, high):
            return following
        at = following
    return at
