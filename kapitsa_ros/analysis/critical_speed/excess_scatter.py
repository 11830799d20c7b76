"""The error that readings must have beyond the stated ones, where a fit is improbably bad."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from scipy.optimize import brentq
from scipy.special import chdtri, stdtrit  # importing scipy.stats takes a second

if TYPE_CHECKING:
    from collections.abc import Callable

_IMPROBABLE = 0.001  # probability of a χ² this large below which the errors stated are not all there are
_SMALLEST, _LARGEST = 1e-7, 0.3  # of a period; with more, it was not timed


def improbable(chi_squared: float, freedom: int) -> bool:
    """Tell whether χ² is too large for the errors stated; without degrees of freedom there is no answer."""
    return freedom > 0 and bool(chi_squared > chdtri(freedom, _IMPROBABLE))


def excess_scatter(chi_squared: Callable[[float], float], freedom: int) -> float | None:
    """Find the common relative error of the periods at which χ² is its expectation.

    The method is that of Mandel and Paule (Anal. Chem. 42, 1194 (1970)). Unlike a factor on all errors it leaves alone
    what is known otherwise, such as a ruler's reading.

    Parameters
    ----------
    chi_squared
        Of the best fit, as a function of that error.
    freedom
        Degrees of freedom.

    Returns
    -------
    float or None
        None where no error of a period reconciles the readings: they contradict one another.

    """

    def excess(logarithm: float) -> float:
        return chi_squared(math.exp(logarithm)) - freedom

    if excess(math.log(_LARGEST)) > 0.0:
        return None
    if excess(math.log(_SMALLEST)) < 0.0:
        return _SMALLEST
    return math.exp(brentq(excess, math.log(_SMALLEST), math.log(_LARGEST), xtol=0.01))


def rise_95(freedom: int) -> float:
    """Return by how much χ² rises to the ends of a 95 % interval when the errors were judged by the scatter itself."""
    return float(stdtrit(freedom, 0.975)) ** 2
