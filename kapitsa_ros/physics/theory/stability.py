"""The stability map: a million points of (ω, λ) from a few hundred monodromy matrices.

Half the trace D(a, q) of the monodromy matrix is an entire function of both arguments, so a tensor of Chebyshev
interpolants has it to rounding, and a map over speeds and amplitudes is a product of three thin matrices.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.errors import ParameterError, PhysicsError
from kapitsa_ros.physics.kernels.mathieu import half_trace
from kapitsa_ros.physics.theory.mathieu import mathieu_q

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from kapitsa_ros.physics.parameters import PlantParameters

PROMISED = 1e-10
NODES_A = 22
NODES_Q = 22
WIDEST = 1.0  # of a patch, in √−a and in √q: within it D changes by less than e^(2π)


@dataclass(frozen=True, kw_only=True, eq=False)
class StabilityMap:
    """Upright stability over amplitudes (rows) and speeds (columns)."""

    half_trace: NDArray[np.float64]
    """D of the undamped companion w (see `mathieu`): its error is below 1e-10 of max(1, |D|)."""
    stable: NDArray[np.bool_]
    """|D| ≤ cosh(πc/ω): both multipliers within the unit circle."""


def stability_map(plant: PlantParameters, speeds: ArrayLike, amplitudes: ArrayLike) -> StabilityMap:
    """Map upright stability.

    Parameters
    ----------
    plant
        Its own amplitude does not enter.
    speeds
        ω, rad/s, shape (n,), in any order.
    amplitudes
        λ, m, shape (m,), in any order.

    Returns
    -------
    StabilityMap
        Shape (m, n).

    Raises
    ------
    ParameterError
        A speed or an amplitude is not finite and above 0.
    PhysicsError
        The promised 1e-10 cannot be kept.

    """
    omega, lam = np.asarray(speeds, dtype=float), np.asarray(amplitudes, dtype=float)
    for name, values in (('speed', omega), ('amplitude', lam)):
        if values.ndim != 1 or not np.all(np.isfinite(values) & (values > 0)):
            raise ParameterError(f'{name}s: give one dimension of finite numbers above 0')
    root_a = math.sqrt(4.0 * plant.k * plant.gravity + plant.damping**2) / omega
    root_q = np.sqrt(mathieu_q(replace(plant, amplitude=1.0)) * lam)
    trace = np.empty((lam.size, omega.size))
    for rows in _patches(root_q):
        for columns in _patches(root_a):
            trace[np.ix_(rows, columns)] = _patch(root_q[rows] ** 2, -(root_a[columns] ** 2))
    limit = np.cosh(np.pi * plant.damping / omega)
    return StabilityMap(half_trace=trace, stable=np.abs(trace) <= limit)


def _patches(roots: NDArray[np.float64]) -> list[NDArray[np.intp]]:
    """Group values so that none is farther than WIDEST from another of its group."""
    group = np.floor(roots / WIDEST)
    return [np.flatnonzero(group == one) for one in np.unique(group)]


def _patch(q: NDArray[np.float64], a: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return D for every pair, interpolated over their range, and spot-checked against the monodromy matrix."""
    nodes_q, weights_q = _interpolation(q, NODES_Q)
    nodes_a, weights_a = _interpolation(a, NODES_A)
    trace = weights_q @ half_trace(nodes_a, nodes_q) @ weights_a.T
    rows, columns = (np.unique(np.linspace(0, size - 1, 7).astype(int)) for size in (q.size, a.size))
    exact = half_trace(a[columns], q[rows])
    error = np.max(np.abs(trace[np.ix_(rows, columns)] - exact) / np.maximum(1.0, np.abs(exact)))
    if not error < 0.1 * PROMISED:
        raise PhysicsError(f'the stability map would err by {error:.1g} of the half-trace: leave out the lowest speeds')
    return np.asarray(trace)


def _interpolation(values: NDArray[np.float64], count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return Chebyshev nodes over the values' range and the weights that carry node values to the values.

    The weights are those of the discrete cosine transform: Σ T_k(x) T_k(x_j), numerically as stable as Clenshaw's rule.
    """
    low, high = float(values.min()), float(values.max())
    centre, radius = 0.5 * (low + high), max(0.5 * (high - low), 1e-12 * max(abs(low), abs(high)))
    angle = (np.arange(count) + 0.5) * (np.pi / count)
    order = np.arange(count)
    at_nodes = np.cos(np.outer(angle, order)) * np.where(order == 0, 1.0, 2.0) / count
    position = np.clip((values - centre) / radius, -1.0, 1.0)
    return centre + radius * np.cos(angle), np.polynomial.chebyshev.chebvander(position, count - 1) @ at_nodes.T
