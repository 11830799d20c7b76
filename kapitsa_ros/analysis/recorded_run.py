"""A run together with the motion that was recorded of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.slow_frequency.estimate import SwingRecord

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.network.run import Run
    from kapitsa_ros.network.timing import Timing

_HELD = 0.05  # s
_DEAD = 0.2  # of the first swing's width: what is narrower belongs to the end that friction makes of it


@dataclass(frozen=True, kw_only=True, eq=False)
class FreeSwing:
    """What the pendulum did between two holds."""

    released: float
    """Seconds of the run."""
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
    defects: tuple[str, ...] = ()
    """What is missing or damaged in its record, a sentence each."""
    unverified: bool = False
    """Whether the record carries no digest that would show a change."""

    def has_moved(self) -> bool:
        """Whether there is a motion to be looked at."""
        return self.angle.size > 1 and bool(np.ptp(self.angle) > 0.0)

    def swings(self) -> tuple[FreeSwing, ...]:
        """Return the stretches of free motion, each from a release on until the pendulum is held again or rests.

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
        return tuple(
            FreeSwing(
                released=float(self.time[begin]),
                time=self.time[begin : end + 1] - self.time[begin],
                angle=self.angle[begin : end + 1],
            )
            for begin, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True)
            if end - begin > held  # shorter is the hand that takes the rod
        )

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
        return SwingRecord(angle=chosen.angle[:end], period=period, forcing=self.forcing_of(chosen))

    def timing_of(self, swing: FreeSwing) -> Timing | None:
        """Return what was timed of a swing; None where nothing was."""
        ends = swing.released + float(swing.time[-1]) + _HELD
        return next((each for each in self.run.timings if swing.released < each.time <= ends), None)

    def forcing_of(self, swing: FreeSwing) -> float:
        """Return the speed that was asked for while a swing lasted, rad/s; where it was changed, the run's last."""
        timing = self.timing_of(swing)
        return self.run.speed_asked if timing is None or timing.speed_asked is None else timing.speed_asked
