"""What a blind analyst has in hand: readings with their errors, falls, and a ruler."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from kapitsa_ros.analysis.slow_frequency.stopwatch_period import stopwatch_period
from kapitsa_ros.analysis.table import Readings
from kapitsa_ros.instruments.dial_search import standing_ratios
from kapitsa_ros.instruments.errors import SettingsError
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.instruments.strobe_images import faintest
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.network.errors import RunError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from kapitsa_ros.network.run import Run

_Kind = TypeVar('_Kind', StrobeSettings, StopwatchSettings)

RULER_SIGMA = 0.125e-3
"""m; of λ, half of what a steel ruler leaves open of the stroke between its two ends (0.25 mm)."""

_ALIAS = 0.03  # a reading this near a simple ratio of the speed asked is taken for one


@dataclass(frozen=True, kw_only=True)
class Ruler:
    """What a ruler says of the stroke."""

    amplitude: float
    """λ, m."""
    sigma: float = RULER_SIGMA
    """Standard error, m."""


@dataclass(frozen=True, kw_only=True)
class Bound:
    """A run that fell or stayed up, and so bounds the critical speed."""

    speed: float
    """ω, rad/s."""
    sigma: float
    """Its standard error, rad/s."""
    release: float
    """θ at which the pendulum was let go, rad."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Evidence:
    """The readings of several runs of one plant, SI units."""

    timed: Readings
    """Runs whose swings were timed."""
    release: NDArray[np.float64]
    """|θ| at which the pendulum was let go in each of them, rad, shape (N,)."""
    swings: int = 3
    """Full swings a timing."""
    fell: tuple[Bound, ...] = ()
    """Runs in which the pendulum fell over."""
    stood: tuple[Bound, ...] = ()
    """Runs in which it stayed up, though its swings were not timed to the end."""


def evidence_of(runs: Sequence[Run]) -> Evidence:
    """Gather what the readings of several runs say; the motion is not looked at.

    Raises
    ------
    RunError
        There are no runs, or their settings do not describe their instruments.
    TableError
        The readings are none that runs can have.

    """
    if not runs:
        raise RunError('no runs: give one or more')
    rows: list[tuple[float, ...]] = []
    bounds: dict[str, list[Bound]] = {'fell': [], 'stopped': []}
    for run in runs:
        if run.speed_reading is None:
            continue
        strobe = _settings(run, 'strobe', StrobeSettings)
        speed = undo_alias(run.speed_reading, run.speed_asked, strobe) if run.speed_asked > 0.0 else run.speed_reading
        bound = Bound(speed=speed, sigma=dial_sigma(strobe), release=abs(run.release or 0.0))
        done = [reading for reading in run.timings if reading.kind == 'timed']
        if done:
            watch = _settings(run, 'stopwatch', StopwatchSettings)
            lap = stopwatch_period([reading.displayed for reading in done], [reading.swings for reading in done], watch)
            rows.append((speed, lap.value, bound.sigma, lap.sigma, bound.release))
        for kind in {reading.kind for reading in run.timings} & bounds.keys():
            bounds[kind].append(bound)
    columns = np.array(rows, dtype=np.float64).reshape(-1, 5).T
    return Evidence(
        timed=Readings(columns[0], columns[1], columns[2], columns[3]),
        release=columns[4],
        swings=max((reading.swings for run in runs for reading in run.timings if reading.kind == 'timed'), default=1),
        fell=tuple(bounds['fell']),
        stood=tuple(bounds['stopped']),
    )


def dial_sigma(strobe: StrobeSettings) -> float:
    """Return the standard error of a speed read off the dial and halved, rad/s: a drift not seen, and a graduation."""
    return math.hypot(strobe.drift_limit / math.sqrt(3.0), 0.5 * strobe.dial_resolution / math.sqrt(12.0))


def undo_alias(reading: float, speed_asked: float, strobe: StrobeSettings) -> float:
    """Undo an alias of the strobe, since the operator knows roughly the speed asked.

    The person stops at a flash rate of (p/q)·ω and halves; where that is not twice ω the reading is p/(2q) times the
    speed. A reading that fits no such ratio is left as it is.
    """
    if abs(reading / speed_asked - 1.0) <= _ALIAS:
        return reading
    ratios = [ratio / 2 for ratio in standing_ratios(0.5, 10.0, faintest(strobe)) if ratio != Fraction(2)]
    ratio = min(ratios, key=lambda ratio: abs(math.log(reading / (float(ratio) * speed_asked))))
    speed = reading / float(ratio)
    return speed if abs(speed / speed_asked - 1.0) <= _ALIAS else reading


def _settings(run: Run, name: str, kind: type[_Kind]) -> _Kind:
    try:
        return kind(**run.settings[name]['instrument'])
    except (KeyError, TypeError, SettingsError) as error:
        raise RunError(f'run {run.number}: its settings do not describe the {name} ({error})') from error
