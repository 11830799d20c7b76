# ruff: noqa: PLR0917 (compiled functions take their arrays by position)
"""Power series of the rod's angle, and the polynomials that go with it.

A step is one unit of the local time τ; every series is scaled to it, so its coefficients shrink as it converges.
Recurrences for sine and cosine: Jorba & Zou, Experimental Mathematics 14 (2005) 99, prop. 1.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.kernels.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

MAX_ORDER = 32
BINOMIAL = np.array([[float(math.comb(n, k)) for k in range(MAX_ORDER + 1)] for n in range(MAX_ORDER + 1)])
RECIPROCAL = np.array([0.0] + [1.0 / n for n in range(1, MAX_ORDER + 3)])


@kernel
def expand(
    drive: NDArray[np.float64],
    damping: float,
    friction: float,
    linear: bool,  # noqa: FBT001
    angle: NDArray[np.float64],
    sine: NDArray[np.float64],
    cosine: NDArray[np.float64],
    slope: NDArray[np.float64],
) -> None:
    """Fill `angle` with the solution of θ̈ = drive(τ) sin θ − damping θ̇ − friction from angle[0] and angle[1].

    Parameters
    ----------
    drive
        Coefficients of h² k (g + y″), shape (order − 1,).
    damping, friction
        h c and h² f sgn θ′.
    linear
        Take θ for sin θ.
    angle
        Shape (order + 1,): θ and h θ′ on entry, the series on return.
    sine, cosine, slope
        Work space of the same shape; `sine` and `cosine` come back as the series of sin θ and cos θ.

    """
    sine[0] = angle[0] if linear else math.sin(angle[0])
    cosine[0] = 1.0 if linear else math.cos(angle[0])
    slope[1] = angle[1]
    angle[2] = 0.5 * (drive[0] * sine[0] - friction - damping * angle[1])
    for n in range(1, angle.size - 2):
        # Every other term goes to a sum of its own: a sum waits for its last addition, two run side by side.
        rising, falling, torque = 0.0, 0.0, 0.0
        rising_too, falling_too, torque_too = 0.0, 0.0, 0.0
        for j in range(1, n, 2):
            rising += slope[j] * cosine[n - j]
            falling += slope[j] * sine[n - j]
            torque += drive[j] * sine[n - j]
            rising_too += slope[j + 1] * cosine[n - j - 1]
            falling_too += slope[j + 1] * sine[n - j - 1]
            torque_too += drive[j + 1] * sine[n - j - 1]
        if n % 2 == 1:
            rising += slope[n] * cosine[0]
            falling += slope[n] * sine[0]
            torque += drive[n] * sine[0]
        rising += rising_too
        falling += falling_too
        torque += torque_too
        sine[n] = angle[n] if linear else rising * RECIPROCAL[n]
        cosine[n] = -falling * RECIPROCAL[n]
        torque += drive[0] * sine[n]
        slope[n + 1] = (n + 1) * angle[n + 1]
        angle[n + 2] = (torque - damping * slope[n + 1]) * (RECIPROCAL[n + 1] * RECIPROCAL[n + 2])


@kernel
def value(series: NDArray[np.float64], at: float) -> float:
    """Evaluate a series by Horner's rule."""
    return value_and_slope(series, at)[0]


@kernel
def value_and_slope(series: NDArray[np.float64], at: float) -> tuple[float, float]:
    """Evaluate a series and its first derivative by Horner's rule."""
    height, slope = 0.0, 0.0
    for n in range(series.size - 1, -1, -1):
        slope = slope * at + height
        height = height * at + series[n]
    return height, slope


@kernel
def shift(series: NDArray[np.float64], by: float, sums: NDArray[np.float64]) -> None:
    """Re-centre a polynomial at τ = `by`, in place: each coefficient is its own Horner's rule over those above it.

    All of them go on side by side, in `sums`, of the same shape: each waits for its last addition.
    """
    for k in range(series.size):
        sums[k] = 0.0
    for n in range(series.size - 1, -1, -1):
        coefficient = series[n]
        for k in range(n + 1):
            sums[k] = sums[k] * by + BINOMIAL[n, k] * coefficient
    for k in range(series.size):
        series[k] = sums[k]
