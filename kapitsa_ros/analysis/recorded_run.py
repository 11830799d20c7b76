"""A run together with the motion that was recorded of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import AnalysisError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.analysis.slow_frequency.estimate import SwingRecord
    from kapitsa_ros.network.run import Run
    from kapitsa_ros.network.timing import Timing

_HELD = 0.05  # s
_DEAD = 0.2  # of the first swing's width: what is narrower belongs to the end that friction makes of it


@dataclass(frozen=True, kw_only=True, eq=False)
class FreeSwing:
    """What the pendulum did between two holds, at one speed asked for."""

    released: float
    """Seconds of the run."""
    until: float
    """Seconds of the run at which the next one was let go; infinite of the last."""
    time: NDArray[np.float64]
    """Seconds since the release, equidistant, shape (N,)."""
    angle: NDArray[np.float64]
    """θ, rad, shape (N,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordedRun:
    """A run and its motion."""

    name: str
    run: Run
    time: NDArray[np.float64]
    """Seconds of the run, equidistant, shape (N,)."""
    angle: NDArray[np.float64]
    """θ, rad, shape (N,)."""
    asked: tuple[tuple[float, float], ...] = ()
    """From which second of the run on which ω was asked for, rad/s; nothing where one speed was, all the time."""
    defects: tuple[str, ...] = ()
    """What is missing or damaged in its record, a sentence each."""
    unverified: bool = False
    """Whether the record carries no digest that would show a change."""

    def has_moved(self) -> bool:
        """Whether there is a motion to be looked at."""
        return self.angle.size > 1 and bool(np.ptp(self.angle) > 0.0)

    def swings(self) -> tuple[FreeSwing, ...]:
        """Return the stretches of free motion.

        Each lasts from a release until the pendulum is held again or rests, or another speed is asked for.

        Raises
        ------
        AnalysisError
            No motion was recorded, or the pendulum never moved.

        """
        if self.angle.size < 2:
            raise AnalysisError(f'{self.name}: no motion was recorded; analyse the readings instead')
        moving = np.abs(np.diff(self.angle)) > 0.0
        if not moving.any():
            raise AnalysisError(f'{self.name} shows no swing: the pendulum never moved')
        # friction may make the rod stick for a moment in every turn of the shaft: a hand holds for longer
        held = max(1, round(_HELD / float(np.median(np.diff(self.time)))))
        before = np.concatenate(((0,), np.cumsum(moving)))
        begins_still = np.flatnonzero(before[held:] == before[:-held])
        still = np.zeros(moving.size, dtype=np.int64)
        np.add.at(still, begins_still, 1)
        np.add.at(still, begins_still[begins_still + held < still.size] + held, -1)
        edges = np.diff(np.concatenate(((0,), np.cumsum(still) == 0, (0,))).astype(np.int64))
        stretches = [
            (int(begin), self._end_at_one_speed(int(begin), int(end)))
            for begin, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True)
            if end - begin > held  # shorter is the hand that takes the rod
        ]
        releases = [float(self.time[begin]) for begin, _ in stretches]
        ends = [*releases, math.inf][1:]
        return tuple(
            FreeSwing(
                released=released,
                until=until,
                time=self.time[begin : end + 1] - released,
                angle=self.angle[begin : end + 1],
            )
            for (begin, end), released, until in zip(stretches, releases, ends, strict=True)
        )

    def _end_at_one_speed(self, begin: int, end: int) -> int:
        """Return the sample at which another speed was asked for, where that was before the end."""
        start = float(self.time[begin]) + _HELD
        change = next((seconds for seconds, _ in self.asked if seconds > start), math.inf)
        return min(end, int(np.searchsorted(self.time, change)))

    def free_swing(self) -> FreeSwing:
        """Return the last of them.

        Raises
        ------
        AnalysisError
            There is none.

        """
        swings = self.swings()
        if not swings:
            raise AnalysisError(f'{self.name} shows no swing: the pendulum was held all the time')
        return swings[-1]

    def living_swing(self, swing: FreeSwing | None = None) -> SwingRecord:
        """Return the part of a free swing, by default the last, that still is one.

        Raises
        ------
        AnalysisError
            It is too short to tell anything.

        """
        chosen = swing or self.free_swing()
        wide = np.flatnonzero(np.abs(chosen.angle) > _DEAD * np.abs(chosen.angle).max())
        end = int(wide[-1]) + 1
        period = float(np.median(np.diff(chosen.time)))
        # Not above: this loads kernels, which who plays or records a run has no use for.
        from kapitsa_ros.analysis.slow_frequency.estimate import SwingRecord  # noqa: PLC0415

        return SwingRecord(angle=chosen.angle[:end], period=period, forcing=self.forcing_of(chosen))

    def timing_of(self, swing: FreeSwing) -> Timing | None:
        """Return what came of a swing; None where nothing was noted."""
        return next((each for each in self.run.timings if swing.released < each.time <= swing.until), None)

    def forcing_of(self, swing: FreeSwing) -> float:
        """Return the speed that was asked for while a swing lasted, rad/s."""
        before = [speed for seconds, speed in self.asked if seconds <= swing.released + _HELD]
        return before[-1] if before else self.run.speed_asked

    def changes_speed(self) -> bool:
        """Tell whether another speed was asked for after the first release."""
        swings = self.swings()
        return bool(swings) and any(seconds > swings[0].released + _HELD for seconds, _ in self.asked)
