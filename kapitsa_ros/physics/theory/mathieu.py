"""The pendulum near upright as Mathieu's equation (report, eqs. 3 to 7), and the edges of its stable tongue.

With z = ωt/2 and θ = e^(−ct/2) w the linear equation is w″ + (a − 2q cos 2z) w = 0; damping only lowers a.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeVar

import numpy as np
import scipy

from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.kernels import mathieu as kernels
from kapitsa_ros.physics.limits import LARGEST_Q

Quantity = TypeVar('Quantity', float, 'NDArray[np.float64]')

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from kapitsa_ros.physics.plant import Plant


def mathieu_a(plant: Plant, speed: Quantity) -> Quantity:
    """Return a = −4kg/ω², which is −6g/(ω²L) for the rod (report, eq. 5); of one speed ω (rad/s) or of an array."""
    return -4.0 * plant.k * plant.gravity / speed**2


def mathieu_q(plant: Plant) -> float:
    """Return q = 2kλ, which is 3λ/L for the rod (report, eq. 6, where the sign is only a phase).

    Raises
    ------
    PhysicsError
        It is beyond `LARGEST_Q`.

    """
    q = 2.0 * plant.k * plant.amplitude
    if q > LARGEST_Q:
        raise PhysicsError(
            f'the amplitude is {plant.amplitude * plant.k * 2.0 / 3.0:.3g} times the length that the rod swings with: '
            'give a smaller amplitude or a longer rod'
        )
    return q


def half_period(a: float, q: float) -> tuple[float, float, float, float]:
    """Return x₁, x₁′, x₂, x₂′ at z = π/2 of the two normal solutions, from (1, 0) and (0, 1) at 0."""
    return kernels.half_period(a, q, np.empty(kernels.WORK_SHAPE))


def half_trace(a: NDArray[np.float64], q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return D, half the trace of the monodromy matrix over z = 0 to π, for every pair of a q (rows) and an a."""
    result = np.empty((q.size, a.size))
    kernels.half_trace(a, q, result, np.empty(kernels.WORK_SHAPE))
    return result


def boundary_perturbed(q: Quantity) -> Quantity:
    """Return the lower edge a = −q²/2 for small q (report, eq. 7)."""
    return -0.5 * q * q


def characteristic_a0(q: float) -> float:
    """Return a₀(q), the lower edge of the stable tongue: the solution even and of period π (DLMF 28.2)."""
    off = np.full(_size(q) - 1, q)
    off[0] *= math.sqrt(2.0)
    guess = _lowest((2.0 * np.arange(_size(q))) ** 2, off)
    return _polished(lambda a: half_period(a, q)[1], guess)


def characteristic_b1(q: float) -> float:
    """Return b₁(q), the upper edge of the stable tongue: the solution odd and of period 2π (DLMF 28.2)."""
    return _polished(lambda a: half_period(a, q)[3], _antiperiodic(q, -q))


def characteristic_a1(q: float) -> float:
    """Return a₁(q), where the next tongue begins: the solution even and of period 2π (DLMF 28.2)."""
    return _polished(lambda a: half_period(a, q)[0], _antiperiodic(q, q))


def _antiperiodic(q: float, corner: float) -> float:
    diagonal = (2.0 * np.arange(_size(q)) + 1.0) ** 2
    diagonal[0] += corner
    return _lowest(diagonal, np.full(_size(q) - 1, q))


def _size(q: float) -> int:
    """Return how many Fourier coefficients matter."""
    return 12 + int(3.0 * math.sqrt(abs(q)))


def _lowest(diagonal: NDArray[np.floating], off: NDArray[np.floating]) -> float:
    return float(np.linalg.eigvalsh(np.diag(diagonal) + np.diag(off, 1) + np.diag(off, -1))[0])


def _polished(edge: Callable[[float], float], guess: float) -> float:
    """Take the rounding of the eigenvalue out of an edge: the power series is good to the last bits near it."""
    return float(scipy.optimize.newton(edge, guess, x1=guess + 1e-6, tol=1e-15))
