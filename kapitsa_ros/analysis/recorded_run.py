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

_HELD = 0.05  # s
_DEAD = 0.2  # of the first swing's width: what is narrower belongs to the end that friction makes of it


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordedRun:
    """A run and its motion."""

    name: str
    run: Run
    time: NDArray[np.float64]
    """Seconds of the run, equidistant, shape (N,)."""
    angle: NDArray[np.float64]
    """θ, rad, shape (N,)."""

    def has_moved(self) -> bool:
        """Whether there is a motion to be looked at."""
        return self.angle.size > 1 and bool(np.ptp(self.angle) > 0.0)

    def free_swing(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the time since the last release, and the angle from there on.

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
        # friction may have stopped the rod at last: the swing is the last stretch of motion
        last = int(np.flatnonzero(moving)[-1])
        # it may also stick for a moment in every turn of the shaft: a hand holds for longer
        held = max(1, round(_HELD / float(np.median(np.diff(self.time)))))
        before = np.concatenate(((0,), np.cumsum(moving)))
        still = np.flatnonzero(before[held : last + 1] == before[: last + 1 - held])
        begin = int(still[-1]) + held if still.size else 0
        return self.time[begin : last + 2] - self.time[begin], self.angle[begin : last + 2]

    def living_swing(self) -> SwingRecord:
        """Return the part of the free swing that still is one.

        Raises
        ------
        AnalysisError
            It is too short to tell anything.

        """
        time, angle = self.free_swing()
        wide = np.flatnonzero(np.abs(angle) > _DEAD * np.abs(angle).max())
        end = int(wide[-1]) + 1
        return SwingRecord(angle=angle[:end], period=float(np.median(np.diff(time))), forcing=self.run.speed_asked)
