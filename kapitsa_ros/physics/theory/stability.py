"""The stability map: a million points of (ω, λ) from a few hundred monodromy matrices.

Half the trace D(a, q) of the monodromy matrix is an entire function of both arguments, so a tensor of Chebyshev
interpolants has it to rounding, and a map over speeds and amplitudes is a product of three thin matrices.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.errors import ParameterError, PhysicsError
from kapitsa_ros.physics.kernels.mathieu import combine
from kapitsa_ros.physics.theory.mathieu import half_trace, mathieu_q

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from kapitsa_ros.physics.plant import Plant

PROMISED = 1e-10
NODES = 18
BAND = 32  # rows at a time: they stay in the cache, a map does not
WIDEST = 1.0  # of a patch, in √−a and in √q: within it D changes by less than e^(2π)


@dataclass(frozen=True, kw_only=True, eq=False)
class StabilityMap:
    """Upright stability over amplitudes (rows) and speeds (columns)."""

    half_trace: NDArray[np.float64]
    """D of the undamped companion w (see `mathieu`): its error is below 1e-10 of max(1, |D|)."""
    stable: NDArray[np.bool_]
    """|D| ≤ cosh(πc/ω): both multipliers within the unit circle."""


def stability_map(plant: Plant, speeds: ArrayLike, amplitudes: ArrayLike) -> StabilityMap:
    """Map upright stability.

    Parameters
    ----------
    plant
        Its own amplitude does not enter.
    speeds
        ω, rad/s, shape (n,), ascending.
    amplitudes
        λ, m, shape (m,), ascending.

    Returns
    -------
    StabilityMap
        Shape (m, n).

    Raises
    ------
    ParameterError
        A speed or an amplitude is not finite and above 0, or they do not ascend.
    PhysicsError
        The promised 1e-10 cannot be kept.

    """
    omega, lam = _axis('speeds', speeds), _axis('amplitudes', amplitudes)
    root_a = math.sqrt(4.0 * plant.k * plant.gravity + plant.damping**2) / omega
    root_q = np.sqrt(mathieu_q(replace(plant, amplitude=1.0)) * lam)
    trace = np.empty((lam.size, omega.size))
    for rows in _patches(root_q):
        for columns in _patches(root_a):
            _fill(trace[rows, columns], root_q[rows] ** 2, -(root_a[columns] ** 2))
    limit = np.cosh(np.pi * plant.damping / omega)
    stable = np.empty(trace.shape, dtype=bool)
    for start in range(0, lam.size, BAND):
        band = slice(start, start + BAND)
        np.less_equal(np.abs(trace[band]), limit, out=stable[band])
    return StabilityMap(half_trace=trace, stable=stable)


def _axis(name: str, values: ArrayLike) -> NDArray[np.float64]:
    axis = np.asarray(values, dtype=float)
    if axis.ndim != 1 or axis.size == 0 or not np.all(np.isfinite(axis) & (axis > 0)) or np.any(np.diff(axis) < 0):
        raise ParameterError(f'{name}: give one dimension of finite, ascending numbers above 0')
    return axis


def _patches(roots: NDArray[np.float64]) -> list[slice]:
    """Cut a monotonic axis where √ passes a multiple of WIDEST."""
    cuts = np.flatnonzero(np.diff(np.floor(roots / WIDEST))) + 1
    return [slice(*ends) for ends in pairwise((0, *cuts.tolist(), roots.size))]


def _fill(trace: NDArray[np.float64], q: NDArray[np.float64], a: NDArray[np.float64]) -> None:
    """Fill in D for every pair, interpolated over their range, and spot-check it against the monodromy matrix."""
    nodes_q, weights_q = _interpolation(q)
    nodes_a, weights_a = _interpolation(a)
    across = np.empty((NODES, a.size))
    combine(half_trace(nodes_a, nodes_q), np.ascontiguousarray(weights_a.T), across)
    combine(weights_q, across, filled := np.empty(trace.shape))
    trace[:] = filled  # a part of the map, whose rows do not lie behind one another
    rows, columns = (np.unique(np.linspace(0, size - 1, 7).astype(int)) for size in (q.size, a.size))
    exact = half_trace(a[columns], q[rows])
    error = np.max(np.abs(trace[np.ix_(rows, columns)] - exact) / np.maximum(1.0, np.abs(exact)))
    if not error < 0.1 * PROMISED:
        raise PhysicsError(f'the stability map would err by {error:.1g} of the half-trace: leave out the lowest speeds')


def _interpolation(values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return Chebyshev nodes over the values' range and the weights that carry node values to the values.

    The weights are those of the discrete cosine transform: Σ T_k(x) T_k(x_j), as stable as Clenshaw's rule.
    """
    low, high = float(values.min()), float(values.max())
    centre, radius = 0.5 * (low + high), max(0.5 * (high - low), 1e-12 * max(abs(low), abs(high)))
    angle = (np.arange(NODES) + 0.5) * (np.pi / NODES)
    order = np.arange(NODES)
    at_nodes = np.cos(np.outer(angle, order)) * np.where(order == 0, 1.0, 2.0) / NODES
    position = np.clip((values - centre) / radius, -1.0, 1.0)
    return centre + radius * np.cos(angle), np.cos(np.outer(np.arccos(position), order)) @ at_nodes.T
