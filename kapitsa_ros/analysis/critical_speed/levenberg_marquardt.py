"""Levenberg and Marquardt's method for residuals that are known at many points in one call."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import leastsq

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_STEP = math.sqrt(np.finfo(np.float64).eps)  # of a forward difference
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

    The residuals and their forward differences come of one call: what is cheap for many points at once costs no more.

    Parameters
    ----------
    residuals
        From M sets of parameters, shape (M, P), to their residuals, shape (M, R).
    start
        Shape (P,), none 0: each parameter's scale is a thousandth of its start.

    """
    linear = _Linear(residuals)
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

    def __init__(self, residuals: Callable[[Array], Array]) -> None:
        self._residuals = residuals
        self._place = b''
        self._here: tuple[Array, Array]

    def at(self, parameters: Array) -> tuple[Array, Array]:
        """Return them, shapes (R,) and (R, P)."""
        place = parameters.tobytes()
        if place != self._place:
            step = np.where(parameters >= 0.0, _STEP, -_STEP) * np.maximum(1.0, np.abs(parameters))
            ahead = parameters + step
            sets = np.empty((parameters.size + 1, parameters.size))
            sets[:] = parameters
            sets.flat[parameters.size :: parameters.size + 1] = ahead  # a row each with one parameter ahead
            found = self._residuals(sets)
            self._here = found[0], (found[1:] - found[0]).T / (ahead - parameters)
            self._place = place
        return self._here
