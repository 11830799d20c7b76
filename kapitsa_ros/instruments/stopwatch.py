"""The stopwatch in the hands of a person who watches the swing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from kapitsa_ros.instruments.errors import InstrumentError
from kapitsa_ros.instruments.press_errors import PressErrors, display, draw_press_errors
from kapitsa_ros.instruments.swing_observer import SwingObserver

if TYPE_CHECKING:
    import numpy as np

    from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
    from kapitsa_ros.instruments.swing_observer import SwingSight
    from kapitsa_ros.physics.sampled_motion import SampledMotion

_FIRST_WAIT = 10.0  # s; a swing not known yet is waited for this long
_WAIT = 8  # half swings without a passage, and the swing has died


@dataclass(frozen=True, kw_only=True)
class StopwatchReading:
    """What a release came to."""

    pressed_at: float
    """Seconds of the run: the press that ended the timing, or when the person gave up."""
    displayed: float
    """s on the display; 0 where nothing was timed to its end."""
    swings: int
    """Full swings the display stands for, as counted; where nothing was timed, those seen before it ended."""
    kind: Literal['timed', 'fell', 'stopped']


class Stopwatch:
    """Starts a timing whenever the pendulum is let go after being held still, and gives one reading for each release.

    The thumb gets ready at the first passage through upright and presses at the second, then again after the given
    number of full swings: passages in one direction, none of them near the release.

    Parameters
    ----------
    settings
        Stopwatch, eye and thumb.
    swings
        Full swings a timing, 1 or more.
    rng
        Stream of this instrument in this run.

    Raises
    ------
    InstrumentError
        Fewer than one swing.

    """

    def __init__(self, settings: StopwatchSettings, swings: int, rng: np.random.Generator) -> None:
        if swings < 1:
            raise InstrumentError(f'{swings} swings: time one or more')
        self._settings = settings
        self._swings = swings
        self._rng = rng
        self._eye = SwingObserver(settings.persistence)
        self._timing: _Timing | None = None

    def observe(self, start: float, motion: SampledMotion) -> StopwatchReading | None:
        """Watch the pendulum for one communication step.

        Parameters
        ----------
        start
            Seconds of the run at the block's first sample; after a gap, or with other samples, the person begins anew.
        motion
            Of the pendulum, rad from upright.

        Returns
        -------
        StopwatchReading or None
            The reading that was finished in this step.

        """
        return self.time(self._eye.observe(start, motion))

    def time(self, sight: SwingSight) -> StopwatchReading | None:
        """Do what `observe` does, by what an eye sees of the pendulum in one communication step."""
        if sight.taken:
            self._timing = None
        elif sight.let_go:
            thumb = draw_press_errors(self._settings, self._rng)
            self._timing = _Timing(self._settings, self._swings, thumb, sight.start)
        reading = self._timing.follow(sight) if self._timing else None
        if reading is not None:
            self._timing = None
        return reading


class _Timing:
    """One release, from the moment it is let go."""

    def __init__(self, settings: StopwatchSettings, swings: int, thumb: PressErrors, start: float) -> None:
        self._settings = settings
        self._swings = swings
        self._thumb = thumb
        self._last_passage = 2 + 2 * max(swings + thumb.miscount, 1)
        self._passages = 0
        self._passed_at = start
        self._wait = _FIRST_WAIT
        self._pressed = math.nan
        self._ending = math.inf

    def follow(self, sight: SwingSight) -> StopwatchReading | None:
        """Follow the swing for one step and tell what the release came to, once that is known."""
        for passage in sight.passages:
            self._pass(passage)
        if math.isfinite(self._ending):
            return self._timed() if self._ending <= sight.end else None
        if sight.lying:
            return self._lost(sight.end, 'fell')
        return self._lost(sight.end, 'stopped') if sight.end - self._passed_at > self._wait else None

    def _timed(self) -> StopwatchReading:
        shown = display(self._ending - self._pressed, self._settings)
        return StopwatchReading(pressed_at=self._ending, displayed=shown, swings=self._swings, kind='timed')

    def _lost(self, now: float, kind: Literal['fell', 'stopped']) -> StopwatchReading:
        seen = max(self._passages - 2, 0) // 2
        return StopwatchReading(pressed_at=now, displayed=0.0, swings=seen, kind=kind)

    def _pass(self, time: float) -> None:
        self._passages += 1
        if self._passages > 1:
            self._wait = _WAIT * (time - self._passed_at)
        self._passed_at = time
        if self._passages == 2:
            self._pressed = time + self._thumb.start_delay
        elif self._passages == self._last_passage:
            self._ending = time + self._thumb.stop_delay
