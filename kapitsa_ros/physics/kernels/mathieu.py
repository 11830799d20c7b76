"""Mathieu's equation w″ + (a − 2q cos 2z) w = 0 over half a period, by power series."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kapitsa_ros.physics.kernels.jit import kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ORDER = 24
WORK_SHAPE = (3, ORDER + 1)


@kernel
def half_period(a: float, q: float, work: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Carry the two normal solutions from z = 0 to π/2; `work` is work space, of WORK_SHAPE.

    Returns
    -------
    tuple
        x₁, x₁′, x₂, x₂′ at π/2, from (1, 0) and (0, 1) at 0. Their Wronskian is 1.

    """
    steps = math.ceil(0.5 * math.pi * math.sqrt(abs(a) + 2.0 * abs(q) + 4.0))
    step = 0.5 * math.pi / steps
    frequency, even, odd = work[0], work[1], work[2]
    x1, r1, x2, r2 = 1.0, 0.0, 0.0, step
    for i in range(steps):
        cosine, sine = math.cos(2.0 * i * step), math.sin(2.0 * i * step)
        term = 2.0 * q * step * step
        for n in range(ORDER - 1):
            harmonic = cosine if n % 2 == 0 else sine
            frequency[n] = term * harmonic if n % 4 in (0, 3) else -term * harmonic
            term *= 2.0 * step / (n + 1)
        frequency[0] -= a * step * step
        even[0], even[1], odd[0], odd[1] = x1, r1, x2, r2
        for n in range(ORDER - 1):
            sum1, sum2 = 0.0, 0.0
            for j in range(n + 1):
                sum1 += frequency[j] * even[n - j]
                sum2 += frequency[j] * odd[n - j]
            even[n + 2] = sum1 / ((n + 1) * (n + 2))
            odd[n + 2] = sum2 / ((n + 1) * (n + 2))
        x1, r1, x2, r2 = 0.0, 0.0, 0.0, 0.0
        for n in range(ORDER, 0, -1):
            x1 += even[n]
            r1 += n * even[n]
            x2 += odd[n]
            r2 += n * odd[n]
        x1 += even[0]
        x2 += odd[0]
    return x1, r1 / step, x2, r2 / step


@kernel
def half_trace(
    a: NDArray[np.float64], q: NDArray[np.float64], result: NDArray[np.float64], work: NDArray[np.float64]
) -> None:
    """Fill in D, half the trace of the monodromy matrix over z = 0 to π, for every pair of a q (rows) and an a."""
    for i in range(q.size):
        for j in range(a.size):
            x1, r1, x2, r2 = half_period(a[j], q[i], work)
            result[i, j] = x1 * r2 + r1 * x2


@kernel
def floquet_exponents(
    a: NDArray[np.float64],
    q: float,
    half_angle: NDArray[np.float64],
    spread: NDArray[np.float64],
    work: NDArray[np.float64],
) -> None:
    """Fill in what the Floquet multipliers of w over z = 0 to π turn and stretch by.

    Parameters
    ----------
    a, q
        Of Mathieu's equation, `a` of shape (N,).
    half_angle, spread
        Half their angle, nan where both are real and positive; ln of the modulus of the larger, nan beyond any double:
        shape (N,) each.
    work
        Work space, of WORK_SHAPE.

    """
    for i in range(a.size):
        x1, r1, x2, r2 = half_period(a[i], q, work)
        less_one, plus_one = r1 * x2, x1 * r2
        half_angle[i], spread[i] = math.nan, 0.0
        if not math.isfinite(less_one):
            spread[i] = math.nan
        elif less_one > 0:
            spread[i] = 2.0 * math.asinh(math.sqrt(less_one))
        elif plus_one < 0:
            spread[i] = 2.0 * math.asinh(math.sqrt(-plus_one))
        if less_one < 0:
            half_angle[i] = math.asin(math.sqrt(min(-less_one, 1.0)))


@kernel
def combine(weights: NDArray[np.float64], rows: NDArray[np.float64], out: NDArray[np.float64]) -> None:
    """Write weights @ rows into `out`: for thin matrices, and on one core whatever the BLAS would do."""
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = weights[i, 0] * rows[0, j]
        for k in range(1, rows.shape[0]):
            for j in range(out.shape[1]):
                out[i, j] += weights[i, k] * rows[k, j]
