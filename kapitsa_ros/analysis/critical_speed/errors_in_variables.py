"""A line through squared frequencies that respects the errors of both readings."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import OptimizeResult, brentq, least_squares, minimize_scalar
from scipy.special import gammaincinv

from kapitsa_ros.analysis.critical_speed.excess_scatter import excess_scatter, improbable, rise_95
from kapitsa_ros.analysis.table import require_two_speeds

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from kapitsa_ros.analysis.table import Readings

RISE_95 = float(2.0 * gammaincinv(0.5, 0.95))
"""By how much χ² rises from its minimum to the ends of a 95 % interval of one parameter (Wilks)."""

FLOOR = 1e-6
"""Relative error below which no reading of a table is trusted."""
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
    """At the best line with the errors stated; its expectation is the number of readings less two."""
    discrepancy: float | None = 0.0
    """Relative error of the periods beyond the stated ones, by which the readings agree; None where none does it."""


def errors_in_variables(readings: Readings) -> LineFit:
    """Fit Ω² = slope · (ω² − ω_crit²) to the periods themselves, with the errors of periods and speeds.

    The readings err in T, and T⁻² of an unbiased T is biased: hence the fit in T. The true speeds and periods of the
    runs are parameters too, as the line wants them (York, Can. J. Phys. 44, 1079 (1966)). Replacing them by an
    effective variance would reward steep lines, which make any error of ω count for more.

    Readings too far from any line for their errors get a further one, as in the direct fit.

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
    freedom = readings.period.size - 2
    profile = _Profile(readings)
    best, stated = profile.minimum()
    lowest, rise = stated, RISE_95
    dark: float | None = 0.0
    if improbable(stated, freedom):
        dark = excess_scatter(lambda error: _Profile(_with_error(readings, error)).minimum()[1], freedom)
        rise = rise_95(freedom)
        profile = _Profile(_with_error(readings, dark or 0.0))
        best, lowest = profile.minimum()

    def excess(square: float) -> float:
        return profile.chi_squared(square) - lowest - rise

    ends = (None, None) if dark is None else (_lower_end(excess, best), _upper_end(excess, best, profile.edge))
    return LineFit(
        omega_crit=math.sqrt(best) if best > 0.0 else None,
        interval=ends,
        slope=profile.slope(best),
        chi_squared=stated,
        discrepancy=dark,
    )


def _with_error(readings: Readings, error: float) -> Readings:
    return replace(readings, period_sigma=np.hypot(readings.period_sigma, error * readings.period))


class _Profile:
    """χ² as a function of ω_crit² alone: the slope and the true periods of all runs are fitted each time."""

    def __init__(self, readings: Readings) -> None:
        self._readings = readings
        self.edge = float(readings.forcing.min() ** 2)
        """Lowest speed squared: the critical one is anything below."""
        self._forcing_sigma = np.hypot(readings.forcing_sigma, FLOOR * readings.forcing)
        self._period_sigma = np.hypot(readings.period_sigma, FLOOR * readings.period)

    def _unit(self, square: float) -> float:
        data = self._readings
        return float(np.median((data.forcing**2 - square) / data.slow**2))

    def _fitted(self, square: float) -> OptimizeResult:
        """Fit ω² = ω_crit² + Ω²/slope; the parameters are the root of 1/slope and the errors of T, all relative."""
        data, unit = self._readings, self._unit(square)

        def misfit(parameters: NDArray[np.float64]) -> NDArray[np.float64]:
            slow = data.slow / (1.0 + parameters[1:])
            forcing = np.sqrt(np.maximum(square + unit * (parameters[0] * slow) ** 2, 0.0))
            return np.concatenate(
                ((forcing - data.forcing) / self._forcing_sigma, data.period * parameters[1:] / self._period_sigma)
            )

        def jacobian(parameters: NDArray[np.float64]) -> NDArray[np.float64]:
            growth = unit * (parameters[0] * data.slow / (1.0 + parameters[1:])) ** 2
            forcing = np.sqrt(np.maximum(square + growth, 0.0))
            per_share = np.divide(growth, forcing * self._forcing_sigma, out=np.zeros_like(growth), where=forcing > 0.0)
            change = np.zeros((2 * count, count + 1))
            change[:count, 0] = per_share / parameters[0]
            change[run, 1 + run] = -per_share / (1.0 + parameters[1:])
            change[count + run, 1 + run] = data.period / self._period_sigma
            return change

        count = data.period.size
        run = np.arange(count)
        start = np.append(1.0, np.zeros(count))
        return least_squares(
            misfit, start, jacobian, x_scale=np.full(start.size, 0.1), method='lm', xtol=1e-13, ftol=1e-13, gtol=1e-13
        )

    def minimum(self) -> tuple[float, float]:
        """Return the best ω_crit² and its χ², searched on a scale that reaches far below zero."""
        found = minimize_scalar(
            lambda x: self.chi_squared(self.edge * (1.0 - math.exp(x))),
            bounds=(math.log(1e-9), math.log(_FARTHEST)),
            method='bounded',
            options={'xatol': 1e-10},
        )
        return self.edge * (1.0 - math.exp(found.x)), float(found.fun)

    def slope(self, square: float) -> float:
        """Return the slope of the best line through a given ω_crit²."""
        return 1.0 / (self._unit(square) * float(self._fitted(square).x[0]) ** 2)

    def chi_squared(self, square: float) -> float:
        """Return χ² of the best line through a given ω_crit²."""
        return 2.0 * float(self._fitted(square).cost)


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
