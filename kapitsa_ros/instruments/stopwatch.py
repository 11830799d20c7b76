"""The stopwatch in the hands of a person who watches the swing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from kapitsa_ros.instruments.errors import InstrumentError
from kapitsa_ros.instruments.persistence_filter import PersistenceFilter
from kapitsa_ros.instruments.press_errors import PressErrors, display, draw_press_errors

if TYPE_CHECKING:
    from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
    from kapitsa_ros.physics.sampled_motion import SampledMotion

_STILL = 1e-6  # rad; a pendulum in somebody's hand, stuck, or at its stop moves less than this
_LYING = 1.0  # rad; what is still beyond this has fallen over
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
        self._end = math.nan
        self._period = math.nan
        self._angle = math.nan
        self._held = False
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
        joined = abs(start - self._end) <= motion.period and math.isclose(motion.period, self._period, rel_tol=1e-9)
        still = bool(np.ptp(motion.position) <= _STILL)
        if not joined or abs(motion.position[0] - self._angle) > _STILL:  # a hand has moved it
            self._timing = None
            self._held = still
        elif self._held and not still:
            self._held = False
            thumb = draw_press_errors(self._settings, self._rng)
            self._timing = _Timing(self._settings, self._swings, thumb, start, motion)
        self._end = start + motion.duration
        self._period = motion.period
        self._angle = float(motion.position[-1])
        reading = self._timing.follow(start, motion, still=still) if self._timing else None
        if reading is not None:
            self._timing = None
        return reading


class _Timing:
    """One release, from the moment it is let go."""

    def __init__(
        self, settings: StopwatchSettings, swings: int, thumb: PressErrors, start: float, motion: SampledMotion
    ) -> None:
        self._settings = settings
        self._swings = swings
        self._thumb = thumb
        self._last_passage = 2 + 2 * max(swings + thumb.miscount, 1)
        angle = float(motion.position[0])
        self._eye = PersistenceFilter(settings.persistence, motion.period, angle)
        self._seen = angle
        self._seen_at = start - self._eye.latency
        self._passages = 0
        self._passed_at = start
        self._wait = _FIRST_WAIT
        self._pressed = math.nan
        self._ending = math.inf

    def follow(self, start: float, motion: SampledMotion, *, still: bool) -> StopwatchReading | None:
        """Follow the swing for one block and tell what the release came to, once that is known."""
        blurred = np.concatenate(((self._seen,), self._eye.see(motion.position[1:])))
        upright = np.signbit(blurred)
        for index in np.flatnonzero(upright[1:] != upright[:-1]).tolist():
            before, after = float(blurred[index]), float(blurred[index + 1])
            left = self._seen_at if index == 0 else start + index * motion.period - self._eye.latency
            right = start + (index + 1) * motion.period - self._eye.latency
            self._pass(left + (right - left) * before / (before - after))
        end = start + motion.duration
        self._seen, self._seen_at = float(blurred[-1]), end - self._eye.latency
        if math.isfinite(self._ending):
            return self._timed() if self._ending <= end else None
        if still and abs(float(motion.position[-1])) > _LYING:
            return self._lost(end, 'fell')
        return self._lost(end, 'stopped') if end - self._passed_at > self._wait else None

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
