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

_Tried: TypeAlias = 'Sequence[tuple[Cause, Callable[[float], NDArray[np.float64]]]]'

SUPPORT = RISE_95
"""Explanations within this of the best AIC cannot be told from it.

A true cause that another can imitate with one parameter more loses to it by more in one case of twenty, by chance. Nor
can one be excluded that tunes nothing and misfits no more than in 19 of 20 tables: those that tune fit noise as well.
"""

_REJECTED = 0.001  # probability of a χ² this large below which a cause does not fit
_EXCLUDED = 0.05  # below which it is no candidate beside a better one
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
    ranking, chi_squared = _ranked(readings, plant, tried)
    factors = {'halved': 0.5, 'doubled': 2.0, 'fitted': math.sqrt(chi_squared / max(readings.period.size - 1, 1))}
    with np.errstate(divide='ignore'):
        most = float((readings.period / readings.period_sigma).min())
    return replace(
        ranking,
        with_other_errors=tuple(
            _other_errors(readings, plant, tried, name, factor)
            for name, factor in factors.items()
            if 0.0 < factor < most  # else no period was measured
        ),
    )


def fit_cause(cause: Cause, readings: Readings, plant: Plant) -> Explanation:
    """Fit one cause; its weight, which takes others to weigh it against, is nan."""
    return replace(_fit(cause, _remembered(cause, plant, readings.forcing), readings, plant), weight=math.nan)


def _other_errors(readings: Readings, plant: Plant, tried: _Tried, name: str, factor: float) -> OtherErrors:
    ranking, _ = _ranked(replace(readings, period_sigma=factor * readings.period_sigma), plant, tried)
    first = ranking.explanations[0]
    return OtherErrors(
        name=name, factor=factor, best=ranking.indistinguishable or ((first.name,) if first.fits else ())
    )


def _remembered(cause: Cause, plant: Plant, speeds: NDArray[np.float64]) -> Callable[[float], NDArray[np.float64]]:
    """Return the periods of a cause by its value; what was once worked out is kept."""
    return cache(lambda value: cause.periods(plant, speeds, value))


def _ranked(readings: Readings, plant: Plant, tried: _Tried) -> tuple[Ranking, float]:
    """Return the ranking with the errors stated, and χ² of the best cause that fits by shape, whatever the errors."""
    causes = [cause for cause, _ in tried]
    fitted = [_fit(cause, periods, readings, plant) for cause, periods in tried]
    criteria = np.array([fit.chi_squared + 2.0 * cause.tuned for fit, cause in zip(fitted, causes, strict=True)])
    weights = np.exp(-0.5 * (criteria - criteria.min()))
    weights *= 1.0 / weights.sum() if any(fit.fits for fit in fitted) else math.nan
    order = np.argsort(criteria, kind='stable')
    ranked = tuple(_weighed(fitted[index], float(weights[index])) for index in order)
    supported = tuple(
        fitted[index].name
        for index in order
        if fitted[index].fits
        and (
            criteria[index] - criteria.min() <= SUPPORT
            or (not causes[index].tuned and fitted[index].chi_squared <= _largest(readings, causes[index], _EXCLUDED))
        )
    )
    sigma = readings.period_sigma
    ranking = Ranking(
        explanations=ranked,
        indistinguishable=supported if len(supported) > 1 else (),
        period_sigma=(float(sigma.min()), float(sigma.max())),
        with_other_errors=(),
        warnings=_warnings(readings, ranked),
    )
    return ranking, float(min(fit.chi_squared for fit in fitted))


def _fit(
    cause: Cause, periods: Callable[[float], NDArray[np.float64]], readings: Readings, plant: Plant
) -> Explanation:
    def misfit(value: float) -> NDArray[np.float64]:
        return np.asarray(readings.period - periods(value))

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

    fits = lowest <= _largest(readings, cause, _REJECTED)
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


def _largest(readings: Readings, cause: Cause, probability: float) -> float:
    """Return the χ² that a true cause exceeds with this probability."""
    return float(chdtri(max(readings.period.size - cause.tuned, 1), probability))


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
