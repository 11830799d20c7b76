"""Levenberg and Marquardt's method for residuals that are known at many points in one call."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import leastsq

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_STEP = np.finfo(np.float64).eps ** (1.0 / 3.0)  # of a central difference, in starts
_SCALE = 1e-3
_TOLERANCE = 1e-13
_EVALUATIONS = 100  # a parameter


@dataclass(frozen=True, kw_only=True, eq=False)
class Minimum:
    """Where the sum of squares is smallest."""

    parameters: Array
    """Shape (P,)."""
    residuals: Array
    """Shape (R,)."""
    jacobian: Array
    """Of the residuals by the parameters, shape (R, P)."""

    @property
    def chi_squared(self) -> float:
        """The sum of squares."""
        return float(self.residuals @ self.residuals)


def minimise(residuals: Callable[[Array], Array], start: Array) -> Minimum:
    """Minimise a sum of squares by MINPACK's `lmder`; no derivatives are asked for.

    The residuals and their central differences come of one call: what is cheap for many points at once costs no more.
    With forward differences the curvature along what is all but degenerate would be one of rounding.

    Parameters
    ----------
    residuals
        From M sets of parameters, shape (M, P), to their residuals, shape (M, R).
    start
        Shape (P,), all above 0: each parameter's scale is a thousandth of its start.

    """
    linear = _Linear(residuals, _STEP * start)
    found, _, details, *_ = leastsq(
        lambda parameters: linear.at(parameters)[0],
        start,
        Dfun=lambda parameters: linear.at(parameters)[1],
        full_output=True,
        ftol=_TOLERANCE,
        xtol=_TOLERANCE,
        gtol=_TOLERANCE,
        maxfev=_EVALUATIONS * start.size,
        diag=1.0 / (_SCALE * start),
    )
    return Minimum(parameters=found, residuals=details['fvec'], jacobian=linear.at(found)[1])


class _Linear:
    """Residuals and Jacobian where they were asked for last."""

    def __init__(self, residuals: Callable[[Array], Array], step: Array) -> None:
        self._residuals = residuals
        self._step = step
        self._place = b''
        self._here: tuple[Array, Array]

    def at(self, parameters: Array) -> tuple[Array, Array]:
        """Return them, shapes (R,) and (R, P)."""
        place = parameters.tobytes()
        if place != self._place:
            ahead, behind = parameters + self._step, parameters - self._step
            size = parameters.size
            sets = np.empty((2 * size + 1, size))
            sets[:] = parameters
            of_one = np.arange(size)
            # Where it is, a row each with one parameter ahead, and a row each with one behind.
            sets[1 + of_one, of_one], sets[1 + size + of_one, of_one] = ahead, behind
            found = self._residuals(sets)
            self._here = found[0], (found[1 : 1 + size] - found[1 + size :]).T / (ahead - behind)
            self._place = place
        return self._here
