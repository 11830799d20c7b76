"""The one extra measurement that best tells two explanations apart."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.explain import CAUSES, fit_cause
from kapitsa_ros.analysis.table import PERIOD_SIGMA, require_two_speeds
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.analysis.explain import Cause, Ranking
    from kapitsa_ros.analysis.table import Readings
    from kapitsa_ros.physics.plant import Plant

SMALL = 0.05
"""rad; a release at which no swing is wide."""

_SPEEDS = np.arange(1400.0, 3001.0, 50.0) * RPM


@dataclass(frozen=True, kw_only=True)
class Separation:
    """A measurement and what two explanations say it would give."""

    between: tuple[str, str]
    speed: float
    """ω, rad/s."""
    release: float | None
    """Angle to let go at, rad; None: as before."""
    periods: tuple[float, float]
    """s, by each of the two."""
    sigmas: float
    """Their difference over the error of a period."""


def best_separation(
    readings: Readings,
    plant: Plant,
    first: str,
    second: str,
    period_sigma: float = PERIOD_SIGMA,
    *,
    ranking: Ranking | None = None,
) -> Separation:
    """Fit both causes to the readings, and find the run whose period they differ on most.

    Where all causes have been ranked already, the ranking has the fits. Tried are other speeds with the swing as
    before, and the same with a swing kept small: the period against the amplitude, which only a wide swing answers
    to.

    Raises
    ------
    AnalysisError
        A cause is unknown or named twice, does not fit, or the two agree wherever both can be timed.

    """
    if first == second:
        raise AnalysisError(f'{first} and {second} are one explanation: name two to tell apart')
    causes = [_cause(name) for name in (first, second)]
    require_two_speeds(readings)
    fits = ranking.explanations if ranking else [fit_cause(cause, readings, plant) for cause in causes]
    verdict = {fitted.name: fitted for fitted in fits}
    for cause in causes:
        if not verdict[cause.name].fits:
            raise AnalysisError(f'{cause.name} fits the readings at no value: it is ruled out already')
    values = [verdict[cause.name].value or 0.0 for cause in causes]
    options = []
    for release in (None, SMALL):
        periods = [_periods(cause, plant, value, release) for cause, value in zip(causes, values, strict=True)]
        gap = np.abs(periods[0] - periods[1])
        if not np.isfinite(gap).any():
            continue
        index = int(np.nanargmax(gap))
        options.append(
            Separation(
                between=(first, second),
                speed=float(_SPEEDS[index]),
                release=release,
                periods=(float(periods[0][index]), float(periods[1][index])),
                sigmas=float(gap[index]) / period_sigma,
            )
        )
    if not options:
        raise AnalysisError(f'{first} and {second}: nowhere would both let the swing be timed')
    return max(options, key=lambda option: option.sigmas)


def _periods(cause: Cause, plant: Plant, value: float, release: float | None) -> NDArray[np.float64]:
    return cause.periods(plant, _SPEEDS, release if cause.is_release and release is not None else value)


def _cause(name: str) -> Cause:
    known = {cause.name: cause for cause in CAUSES}
    if name not in known:
        raise AnalysisError(f'no cause {name!r}: choose of {", ".join(known)}')
    return known[name]
