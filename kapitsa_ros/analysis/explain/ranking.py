"""Fit each cause to the readings, weigh them against one another, and say which the data cannot tell apart."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.special import chdtri

from kapitsa_ros.analysis.critical_speed.errors_in_variables import FLOOR, RISE_95
from kapitsa_ros.analysis.explain.causes import CAUSES
from kapitsa_ros.analysis.table import require_two_speeds
from kapitsa_ros.physics.theory.averaged import period_steepness

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from kapitsa_ros.analysis.explain.causes import Cause
    from kapitsa_ros.analysis.table import Readings
    from kapitsa_ros.physics.plant import Plant

SUPPORT = 2.0
"""Explanations within this of the best AIC have substantial support (Burnham & Anderson, Model Selection, 2.6)."""

_REJECTED = 0.001  # probability of a χ² this large below which a cause does not fit
_MISSING = 1e15  # χ² of a run that could not have been timed


@dataclass(frozen=True, kw_only=True)
class Explanation:
    """How one cause fits."""

    name: str
    parameter: str
    value: float | None
    """Best value, SI; None where no value fits or nothing is tuned."""
    interval: tuple[float | None, float | None] | None
    """95 % by profile likelihood; an end is None where the readings do not bound it."""
    rms_misfit: float
    """Of the periods at the best value tried, s."""
    chi_squared: float
    weight: float
    """Akaike weight among the causes; nan where none fits."""
    fits: bool


@dataclass(frozen=True, kw_only=True)
class Ranking:
    """What a table says of all causes."""

    explanations: tuple[Explanation, ...]
    """Best first."""
    indistinguishable: tuple[str, ...]
    """Those with substantial support, where they are more than one."""
    warnings: tuple[str, ...]


def explain(readings: Readings, plant: Plant, causes: Sequence[Cause] = CAUSES) -> Ranking:
    """Fit every cause alone and rank them by Akaike's information criterion, χ² + 2 for each parameter tuned.

    Raises
    ------
    TableError
        Fewer than two different speeds: any cause fits one.

    """
    require_two_speeds(readings)
    fitted = [_fit(cause, readings, plant) for cause in causes]
    criteria = np.array([fit.chi_squared + 2.0 * cause.tuned for fit, cause in zip(fitted, causes, strict=True)])
    weights = np.exp(-0.5 * (criteria - criteria.min()))
    weights *= 1.0 / weights.sum() if any(fit.fits for fit in fitted) else math.nan
    order = np.argsort(criteria, kind='stable')
    ranked = tuple(_weighed(fitted[index], float(weights[index])) for index in order)
    supported = tuple(
        fitted[index].name for index in order if fitted[index].fits and criteria[index] - criteria.min() <= SUPPORT
    )
    return Ranking(
        explanations=ranked,
        indistinguishable=supported if len(supported) > 1 else (),
        warnings=_warnings(readings, ranked),
    )


def _fit(cause: Cause, readings: Readings, plant: Plant) -> Explanation:
    def misfit(value: float) -> NDArray[np.float64]:
        return np.asarray(readings.period - cause.periods(plant, readings.forcing, value))

    sigma = _effective_sigma(readings, plant)

    def chi_squared(value: float) -> float:
        square = (misfit(value) / sigma) ** 2
        return float(np.where(np.isfinite(square), square, _MISSING).sum())

    grid = cause.values(plant, readings)
    costs = np.array([chi_squared(float(value)) for value in grid])
    index = int(np.argmin(costs))
    best, lowest = float(grid[index]), float(costs[index])
    if not cause.discrete:
        low, high = float(grid[max(index - 1, 0)]), float(grid[min(index + 1, grid.size - 1)])
        found = minimize_scalar(
            chi_squared, bounds=(low, high), method='bounded', options={'xatol': 1e-5 * (high - low)}
        )
        if found.fun < lowest:
            best, lowest = float(found.x), float(found.fun)

    def excess(value: float) -> float:
        return chi_squared(value) - lowest - RISE_95

    fits = bool(lowest <= chdtri(max(readings.period.size - cause.tuned, 1), _REJECTED))
    tells = fits and bool(cause.parameter)
    bounded = tells and not cause.discrete
    seen = misfit(best)
    return Explanation(
        name=cause.name,
        parameter=cause.parameter,
        value=best if tells else None,
        interval=_interval(cause, excess, best, grid, costs > lowest + RISE_95) if bounded else None,
        rms_misfit=float(np.sqrt(np.mean(seen**2))),
        chi_squared=lowest,
        weight=0.0,
        fits=fits,
    )


def _effective_sigma(readings: Readings, plant: Plant) -> NDArray[np.float64]:
    """Add to the error of each period what the error of its speed does to it, by averaged theory."""
    steepness = period_steepness(plant, readings.forcing, readings.slow)
    of_speed = np.hypot(steepness * readings.forcing_sigma, FLOOR)
    return np.hypot(readings.period_sigma, readings.period * of_speed)


def _interval(
    cause: Cause,
    excess: Callable[[float], float],
    best: float,
    grid: NDArray[np.float64],
    outside: NDArray[np.bool_],
) -> tuple[float | None, float | None]:
    """Find the roots of the excess of χ² over its rise, between the points of the grid nearest to the best."""
    below, above = grid[outside & (grid < best)], grid[outside & (grid > best)]
    return (
        float(brentq(excess, below[-1], best, rtol=1e-6)) if below.size else cause.least,
        float(brentq(excess, best, above[0], rtol=1e-6)) if above.size else None,
    )


def _weighed(fit: Explanation, weight: float) -> Explanation:
    return replace(fit, weight=weight)


def _warnings(readings: Readings, ranked: Sequence[Explanation]) -> tuple[str, ...]:
    notes = []
    if readings.period.size <= 3:
        notes.append(
            f'every explanation is tuned to {readings.period.size} points: a good fit is little evidence, '
            'and a constant tuned to them is not a measurement of it'
        )
    if not any(explanation.fits for explanation in ranked):
        notes.append('no single cause fits within the stated errors')
    untimed = [explanation.name for explanation in ranked if not math.isfinite(explanation.rms_misfit)]
    if 'instruments' in untimed:
        notes.append(
            'by theory this rod does not swing at these speeds: check its options (lengths are in metres unless they '
            'carry a unit, as in 9.75in)'
        )
    elif untimed:
        notes.append(f'without a misfit, as its runs could not have been timed: {", ".join(untimed)}')
    return tuple(notes)
