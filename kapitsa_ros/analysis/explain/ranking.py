"""Fit each cause to the readings, weigh them against one another, and say which the data cannot tell apart."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, TypeAlias

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

_Predicted: TypeAlias = 'Callable[[float], NDArray[np.float64]]'
"""Periods by the value of a cause's parameter."""
_Tried: TypeAlias = 'Sequence[tuple[Cause, _Predicted]]'

_EXCLUDED = 0.01  # probability of a misfit this large below which a cause is no candidate beside a better one
SUPPORT = float(chdtri(1, _EXCLUDED))
"""Explanations within this of the best AIC cannot be told from it.

A true cause that another can imitate with one parameter more loses to it by more in one case of a hundred, by chance;
one in twenty would not do, as the best of a dozen is picked. Nor can one be excluded that tunes nothing, or only among
given values, and misfits no more than in 99 of 100 tables: those that tune freely fit noise as well.
"""

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
class OtherErrors:
    """How the ranking would be with other errors of the periods."""

    name: str
    """halved, doubled or fitted."""
    factor: float
    """On the error stated of each period."""
    best: tuple[str, ...]
    """The cause that fits best, and those that cannot be told from it; none where no cause fits."""


@dataclass(frozen=True, kw_only=True)
class Ranking:
    """What a table says of all causes."""

    explanations: tuple[Explanation, ...]
    """Best first."""
    indistinguishable: tuple[str, ...]
    """Those that cannot be told from the best, where there are any."""
    period_sigma: tuple[float, float]
    """Smallest and largest error stated of a period, s: the ranking rests on them."""
    with_other_errors: tuple[OtherErrors, ...]
    """With the errors of the periods halved, doubled, and fitted, so that the best cause has its χ² expected."""
    warnings: tuple[str, ...]


def explain(readings: Readings, plant: Plant, causes: Sequence[Cause] = CAUSES) -> Ranking:
    """Fit every cause alone and rank them by Akaike's information criterion, χ² + 2 for each parameter tuned.

    Raises
    ------
    TableError
        Fewer than two different speeds: any cause fits one.

    """
    require_two_speeds(readings)
    tried = [(cause, _remembered(cause, plant, readings.forcing)) for cause in causes]
    fits = _ranked(readings, plant, tried)
    criteria = np.array([fit.criterion for fit in fits])
    weights = np.exp(-0.5 * (criteria - criteria[0]))
    weights *= 1.0 / weights.sum() if any(fit.fits for fit in fits) else math.nan
    explanations = tuple(
        _explanation(fit, readings, plant, float(weight)) for fit, weight in zip(fits, weights, strict=True)
    )
    lowest = min(fit.chi_squared for fit in fits)
    factors = {'halved': 0.5, 'doubled': 2.0, 'fitted': math.sqrt(lowest / max(readings.period.size - 1, 1))}
    sigma = readings.period_sigma
    with np.errstate(divide='ignore'):
        most = float((readings.period / sigma).min())
    return Ranking(
        explanations=explanations,
        indistinguishable=_indistinguishable(fits),
        period_sigma=(float(sigma.min()), float(sigma.max())),
        with_other_errors=tuple(
            _other_errors(readings, plant, tried, name, factor)
            for name, factor in factors.items()
            if 0.0 < factor < most  # else no period was measured
        ),
        warnings=_warnings(readings, explanations),
    )


def fit_cause(cause: Cause, readings: Readings, plant: Plant) -> Explanation:
    """Fit one cause; its weight, which takes others to weigh it against, is nan."""
    fit = _fit(cause, _remembered(cause, plant, readings.forcing), readings, plant)
    return _explanation(fit, readings, plant, math.nan)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Fit:
    """One cause at its best value."""

    cause: Cause
    periods: _Predicted
    value: float
    chi_squared: float
    grid: NDArray[np.float64]
    costs: NDArray[np.float64]
    """χ² at the points of the grid."""
    fits: bool
    is_candidate: bool
    """Whether its values are given ones, and it misfits no more than they may, however much better another fits."""

    @property
    def criterion(self) -> float:
        return self.chi_squared + 2.0 * self.cause.tuned


def _other_errors(readings: Readings, plant: Plant, tried: _Tried, name: str, factor: float) -> OtherErrors:
    fits = _ranked(replace(readings, period_sigma=factor * readings.period_sigma), plant, tried)
    first = (fits[0].cause.name,) if fits[0].fits else ()
    return OtherErrors(name=name, factor=factor, best=_indistinguishable(fits) or first)


def _remembered(cause: Cause, plant: Plant, speeds: NDArray[np.float64]) -> _Predicted:
    """Return the periods of a cause by its value; what was once worked out is kept."""
    return cache(lambda value: cause.periods(plant, speeds, value))


def _ranked(readings: Readings, plant: Plant, tried: _Tried) -> list[_Fit]:
    """Return the fits, best first."""
    fits = [_fit(cause, periods, readings, plant) for cause, periods in tried]
    return sorted(fits, key=lambda fit: fit.criterion)


def _indistinguishable(ranked: list[_Fit]) -> tuple[str, ...]:
    """Return the names of those that cannot be told from the best, where there are any."""
    lowest = ranked[0].criterion
    names = [fit.cause.name for fit in ranked if fit.fits and (fit.criterion - lowest <= SUPPORT or fit.is_candidate)]
    return tuple(names) if len(names) > 1 else ()


def _chi_squared(periods: _Predicted, readings: Readings, sigma: NDArray[np.float64]) -> Callable[[float], float]:
    def at(value: float) -> float:
        square = ((readings.period - periods(value)) / sigma) ** 2
        return float(np.where(np.isfinite(square), square, _MISSING).sum())

    return at


def _fit(cause: Cause, periods: _Predicted, readings: Readings, plant: Plant) -> _Fit:
    chi_squared = _chi_squared(periods, readings, _effective_sigma(readings, plant))
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
    return _Fit(
        cause=cause,
        periods=periods,
        value=best,
        chi_squared=lowest,
        grid=grid,
        costs=costs,
        fits=lowest <= _largest(readings, cause, _REJECTED),
        is_candidate=cause.discrete and lowest <= float(chdtri(readings.period.size, _EXCLUDED)),
    )


def _explanation(fit: _Fit, readings: Readings, plant: Plant, weight: float) -> Explanation:
    cause, allowed = fit.cause, fit.chi_squared + RISE_95
    chi_squared = _chi_squared(fit.periods, readings, _effective_sigma(readings, plant))
    tells = fit.fits and bool(cause.parameter)
    bounded = tells and not cause.discrete
    misfit = readings.period - fit.periods(fit.value)
    return Explanation(
        name=cause.name,
        parameter=cause.parameter,
        value=fit.value if tells else None,
        interval=_interval(fit, lambda value: chi_squared(value) - allowed, fit.costs > allowed) if bounded else None,
        rms_misfit=float(np.sqrt(np.mean(misfit**2))),
        chi_squared=fit.chi_squared,
        weight=weight,
        fits=fit.fits,
    )


def _largest(readings: Readings, cause: Cause, probability: float) -> float:
    """Return the χ² that a true cause exceeds with this probability."""
    return float(chdtri(max(readings.period.size - cause.tuned, 1), probability))


def _effective_sigma(readings: Readings, plant: Plant) -> NDArray[np.float64]:
    """Add to the error of each period what the error of its speed does to it, by averaged theory."""
    steepness = period_steepness(plant, readings.forcing, readings.slow)
    of_speed = np.hypot(steepness * readings.forcing_sigma, FLOOR)
    return np.hypot(readings.period_sigma, readings.period * of_speed)


def _interval(
    fit: _Fit, excess: Callable[[float], float], outside: NDArray[np.bool_]
) -> tuple[float | None, float | None]:
    """Find the roots of the excess of χ² over its rise, between the points of the grid nearest to the best."""
    below, above = fit.grid[outside & (fit.grid < fit.value)], fit.grid[outside & (fit.grid > fit.value)]
    return (
        float(brentq(excess, below[-1], fit.value, rtol=1e-6)) if below.size else fit.cause.least,
        float(brentq(excess, fit.value, above[0], rtol=1e-6)) if above.size else None,
    )


def _warnings(readings: Readings, ranked: Sequence[Explanation]) -> tuple[str, ...]:
    notes = []
    if readings.period.size <= 3:
        notes.append(
            f'every explanation is tuned to {readings.period.size} points: a good fit is little evidence, '
            'and a constant tuned to them is not a measurement of it'
        )
    if not any(explanation.fits for explanation in ranked):
        notes.append('no single cause fits within the stated uncertainties')
    untimed = [explanation.name for explanation in ranked if not math.isfinite(explanation.rms_misfit)]
    if 'instruments' in untimed:
        notes.append(
            'by theory this rod does not swing at these speeds: check its options (lengths are in metres unless they '
            'carry a unit, as in 9.75in)'
        )
    elif untimed:
        notes.append(f'without a misfit, as its runs could not have been timed: {", ".join(untimed)}')
    return tuple(notes)
