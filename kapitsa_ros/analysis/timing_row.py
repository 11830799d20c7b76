"""A row of the table of timings: what a timing or a fall is taken for, and what was read."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from kapitsa_ros.analysis.slow_frequency.stopwatch_period import stopwatch_period
from kapitsa_ros.analysis.strobe_alias import dial_sigma, find_alias
from kapitsa_ros.instruments.errors import SettingsError
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.message import Message
from kapitsa_ros.network.errors import RunError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from fractions import Fraction

    from kapitsa_ros.network.run import Run
    from kapitsa_ros.network.timing import Kind, Timing

_DOUBTFUL = 0.05  # probability of a miscount from which it is said
_Settings = TypeVar('_Settings', StrobeSettings, StopwatchSettings)


@dataclass(frozen=True, kw_only=True)
class TimingRow:
    """A timing, a fall or a swing that stopped, SI units; None where nothing is known."""

    kind: Kind
    speed: float | None
    """ω it is taken at, rad/s."""
    speed_sigma: float = 0.0
    """Standard error of `speed`."""
    period: float | None = None
    """T it is taken for, s: with half a digit, and with the anticipation of the thumb, made good."""
    period_sigma: float = 0.0
    """Standard error of `period`."""
    speed_asked: float | None = None
    """rad/s; None where it was changed while the swing was timed, too."""
    speed_reading: float | None = None
    """Off the dial, rad/s."""
    alias: Fraction | None = None
    """Ratio of the reading to `speed`, where that is not 1: the marks stood at a wrong flash rate."""
    release: float | None = None
    """θ, rad."""
    swings: int | None = None
    """Full swings, as counted."""
    swings_taken: int | None = None
    """What `period` is taken from, where that is not `swings`: the other readings make it probable."""
    miscount_probability: float | None = None
    """That `swings` is wrong, by the other readings; None where that was not weighed."""
    displayed: float | None = None
    """On the stopwatch, s."""
    time: float | None = None
    """Seconds of the run at which it ended."""
    run: int | None = None
    """Number of the run; None for a row that shares its reading of the dial with no other."""
    unused: str | None = None
    """Why nothing is concluded from it; None where it counts."""

    @property
    def miscount(self) -> str | None:
        """Say that the swings were, or may have been, counted wrong; None where that is improbable."""
        if self.swings_taken is not None:
            said = Message(
                '{swings} swings counted, taken as {taken}, by the other readings',
                swings=self.swings,
                taken=self.swings_taken,
            )
        elif self.miscount_probability is not None and self.miscount_probability > _DOUBTFUL:
            said = Message(
                '{swings} swings counted; {percent:.0f} % probable to be wrong: the interval allows for it',
                swings=self.swings,
                percent=100.0 * self.miscount_probability,
            )
        else:
            return None
        return said if self.run is None else Message('run {run}: {said}', run=self.run, said=said)


def untold_releases(rows: Iterable[TimingRow]) -> int:
    """Return how many timings do not tell from how far the rod was let go: they count as those of small swings."""
    return sum(row.kind == 'timed' and row.unused is None and row.release is None for row in rows)


def timing_rows(runs: Sequence[Run], dial_u: float = 0.0) -> list[TimingRow]:
    """Table the timings of several runs; the motion is not looked at.

    Parameters
    ----------
    runs
        At least one.
    dial_u
        Standard uncertainty of the dial's calibration, relative: a reading may be that far from what was asked for.

    Raises
    ------
    RunError
        There are no runs, or their settings do not describe their instruments.

    """
    if not runs:
        raise RunError('no runs: give one bag or more')
    return [row for run in runs for row in _rows_of(run, dial_u)]


def _rows_of(run: Run, dial_u: float) -> Iterator[TimingRow]:
    strobe, watch = _settings(run, 'strobe', StrobeSettings), _settings(run, 'stopwatch', StopwatchSettings)
    for timing in run.timings:
        unused = _unused(timing)
        speed, alias = None, None
        if timing.speed_reading is not None and unused is None:
            alias = find_alias(timing.speed_reading, timing.speed_asked, strobe, dial_u)
            speed = timing.speed_reading / float(alias)
        timed = timing.kind == 'timed' and unused is None
        lap = stopwatch_period([timing.displayed], [timing.swings], watch) if timed else None
        yield TimingRow(
            kind=timing.kind,
            speed=speed,
            speed_sigma=dial_sigma(strobe),
            period=lap.value if lap else None,
            period_sigma=lap.sigma if lap else 0.0,
            speed_asked=timing.speed_asked,
            speed_reading=timing.speed_reading,
            alias=None if alias == 1 else alias,
            release=timing.release,
            swings=timing.swings,
            displayed=timing.displayed if timing.kind == 'timed' else None,
            time=timing.time,
            run=run.number,
            unused=unused,
        )


def _unused(timing: Timing) -> str | None:
    if timing.speed_asked is None:
        return 'the speed was changed while it lasted'
    if timing.speed_reading is None:
        return 'no speed was read'
    if not (math.isfinite(timing.speed_reading) and timing.speed_reading > 0.0):
        return 'the speed read is none'
    if timing.kind != 'timed':
        return None
    if timing.swings < 1:
        return 'no full swing was counted'
    return None if math.isfinite(timing.displayed) and timing.displayed > 0.0 else 'the stopwatch showed no time'


def _settings(run: Run, name: str, kind: type[_Settings]) -> _Settings:
    try:
        return kind(**run.settings[name]['instrument'])
    except (KeyError, TypeError, SettingsError) as error:
        raise RunError(f'run {run.number}: its settings do not describe the {name} ({error})') from error
