"""A line through squared frequencies that respects the errors of both readings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.stats import chi2

from kapitsa_ros.analysis.table import require_two_speeds

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.analysis.table import Readings

RISE_95 = float(chi2.ppf(0.95, 1))
"""By how much χ² rises from its minimum to the ends of a 95 % interval of one parameter (Wilks)."""

_FLOOR = 1e-6  # relative error below which no reading is trusted
_FARTHEST = 1e4  # of the lowest speed squared: so far down a line's squared critical speed makes all periods equal


@dataclass(frozen=True, kw_only=True)
class LineFit:
    """Ω² = slope · (ω² − ω_crit²), fitted to periods."""

    omega_crit: float | None
    """rad/s; None where the best line meets the axis at no real speed."""
    interval: tuple[float | None, float | None]
    """95 % by profile likelihood, rad/s; an end is None where it is unbounded."""
    slope: float
    """Of Ω² over ω²."""
    chi_squared: float
    """At the best line; its expectation is the number of readings less two."""


def errors_in_variables(readings: Readings) -> LineFit:
    """Fit Ω² = slope · (ω² − ω_crit²) to the periods themselves, with the errors of periods and speeds.

    The readings err in T, and T⁻² of an unbiased T is biased: hence the fit in T. An error of ω counts by its effect
    on T (effective variance, the profile over the unknown true speeds to first order). Given ω_crit², T is linear in
    slope^(−1/2), so that parameter is profiled out in closed form.

    Parameters
    ----------
    readings
        At two different speeds or more.

    Raises
    ------
    TableError
        Fewer than two different speeds.

    """
    require_two_speeds(readings)
    profile = _Profile(readings)
    edge = float(readings.forcing.min() ** 2)
    # The squared critical speed is anything below the lowest speed squared: search on a scale that reaches far down.
    found = minimize_scalar(
        lambda x: profile.chi_squared(edge * (1.0 - math.exp(x))),
        bounds=(math.log(1e-9), math.log(_FARTHEST)),
        method='bounded',
        options={'xatol': 1e-10},
    )
    best, lowest = edge * (1.0 - math.exp(found.x)), float(found.fun)

    def excess(square: float) -> float:
        return profile.chi_squared(square) - lowest - RISE_95

    return LineFit(
        omega_crit=math.sqrt(best) if best > 0.0 else None,
        interval=(_lower_end(excess, best), _upper_end(excess, best, edge)),
        slope=profile.root_slope(best) ** -2,
        chi_squared=lowest,
    )


class _Profile:
    """χ² as a function of ω_crit² alone."""

    def __init__(self, readings: Readings) -> None:
        self._readings = readings

    def _weighed(self, square: float) -> tuple[float, float, float]:
        """Return Σ A T, Σ A² and Σ T², each over the variance; T = A/√slope."""
        data = self._readings
        beyond = data.forcing**2 - square
        shape = 2.0 * math.pi / np.sqrt(beyond)
        moved = data.period * data.forcing / beyond * data.forcing_sigma
        variance = data.period_sigma**2 + moved**2 + (_FLOOR * data.period) ** 2
        weights = 1.0 / variance
        return (
            float(weights @ (shape * data.period)),
            float(weights @ shape**2),
            float(weights @ data.period**2),
        )

    def root_slope(self, square: float) -> float:
        cross, own, _ = self._weighed(square)
        return cross / own

    def chi_squared(self, square: float) -> float:
        cross, own, total = self._weighed(square)
        return max(total - cross**2 / own, 0.0)


def _lower_end(excess: Callable[[float], float], best: float) -> float | None:
    """Find where the profile enters the interval above zero; None where no positive speed is too low."""
    if best <= 0.0 or excess(0.0) <= 0.0:
        return None
    return math.sqrt(brentq(excess, 0.0, best, xtol=1e-12 * best))


def _upper_end(excess: Callable[[float], float], best: float, edge: float) -> float | None:
    """Find where the profile leaves the interval below the lowest speed; None where the readings do not exclude it."""
    start, limit = max(best, 0.0), edge * (1.0 - 1e-9)
    if excess(start) > 0.0 or excess(limit) <= 0.0:
        return None
    return math.sqrt(brentq(excess, start, limit, xtol=1e-12 * edge))
