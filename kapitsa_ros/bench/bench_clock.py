"""Simulated time at the bench, between the blocks in which it comes."""

from __future__ import annotations

import math
from collections import deque

_LATE = 0.25
"""Seconds of simulated time by which a block may be late before the clock follows it: the rig stood still."""
_HISTORY = 3.0
"""Wall seconds over which the rate is measured."""


class BenchClock:
    """Runs on with the wall clock, and is led by the blocks.

    A paced rig makes a block when its simulated time begins, so at any moment the motion is known a little ahead. The
    blocks that come earliest tell the time; those that were held up do not.

    Parameters
    ----------
    rate
        Simulated over wall seconds; 0: as fast as it can, and the time is that of the newest block.

    """

    def __init__(self, rate: float) -> None:
        self._rate = rate
        self.standing = False
        """Whether the rig is paused: the time is that of the newest block, none is under way."""
        self._offset: float | None = None
        self._marks: deque[tuple[float, float]] = deque()
        self.restart()

    @property
    def rate(self) -> float:
        """Simulated over wall seconds, as requested."""
        return self._rate

    @rate.setter
    def rate(self, rate: float) -> None:
        self._rate = rate
        self._offset = None
        self.measure_anew()

    @property
    def known(self) -> float:
        """Until when the motion is known, s of the run."""
        return self._end

    def restart(self) -> None:
        """Begin with a new run."""
        self._offset = None
        self._end = 0.0
        self._shown = 0.0
        self.measure_anew()

    def measure_anew(self) -> None:
        """Forget how fast time went."""
        self._marks.clear()

    def follow(self, wall: float, start: float, end: float) -> None:
        """Take note of a block.

        Parameters
        ----------
        wall
            When it came, s of the wall clock.
        start, end
            Simulated time that it covers, s of the run.

        """
        offset = start - self._rate * wall
        if self._offset is None or offset > self._offset or offset < self._offset - _LATE:
            self._offset = offset
        self._end = end
        self._marks.append((wall, end))

    def now(self, wall: float) -> float:
        """Return the simulated time, s of the run: it never goes back, and not beyond what is known."""
        if self._offset is None:
            return self._shown
        led = self._end if self._rate == 0 or self.standing else self._rate * wall + self._offset
        self._shown = max(self._shown, min(led, self._end))
        return self._shown

    def measured_rate(self, wall: float) -> float:
        """Return simulated over wall seconds of late; NaN where not enough is known."""
        while len(self._marks) > 1 and self._marks[1][0] < wall - _HISTORY:
            self._marks.popleft()
        if len(self._marks) < 2 or wall - self._marks[0][0] < 1.0:
            return math.nan
        return (self._marks[-1][1] - self._marks[0][1]) / (wall - self._marks[0][0])
