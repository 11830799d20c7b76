"""Simulated against wall time."""

from __future__ import annotations

import time

NEXT_RUN = 10_000.0
"""Seconds of simulated time: a leap this long leads to another run, which takes place on a day of its own."""
LATE = 0.5
"""Seconds of wall time behind which lost time is given up instead of caught up."""


class RealTimePacer:
    """Says when a step is due, and keeps the time it took.

    Steps are counted, never triggered by a timer: the steady clock only says how long to wait.
    """

    def __init__(self, rate: float) -> None:
        self._rate = rate
        self.misses = 0
        """How often time was given up."""
        self.simulated = 0.0
        """Seconds from the first step to the last, over all runs."""
        self._steps = 0
        self._origin: tuple[float, float] | None = None
        self._first: float | None = None
        self._last = self._newest = 0.0

    @property
    def rate(self) -> float:
        """Simulated over wall seconds; 0: as fast as it can."""
        return self._rate

    @rate.setter
    def rate(self, rate: float) -> None:
        self._rate = rate
        self.restart()

    def restart(self) -> None:
        """Count from the next step: what went by until then is not caught up."""
        self._origin = None

    def wait(self, simulated: float) -> float:
        """Return the wall seconds until the step that starts at `simulated` seconds is due; at most 0 when it is."""
        if self._rate == 0:
            return 0.0
        now = time.monotonic()
        if self._origin is None or abs(simulated - self._origin[1]) > NEXT_RUN:
            self._origin = (now, simulated)
        due = self._origin[0] + (simulated - self._origin[1]) / self._rate
        if now - due > LATE:
            self.misses += 1
            self._origin = (now, simulated)
            return 0.0
        return due - now

    def count(self, simulated: float) -> None:
        """Note that a step that starts at `simulated` seconds is emitted now."""
        self._last = time.monotonic()
        self._steps += 1
        if self._first is None:
            self._first = self._last
        elif 0 < simulated - self._newest < NEXT_RUN:
            self.simulated += simulated - self._newest
        self._newest = simulated

    @property
    def realtime_factor(self) -> float:
        """Simulated over wall seconds from the first step to the last."""
        return self.simulated / self._wall if self._wall > 0 else 0.0

    @property
    def step_rate(self) -> float:
        """Steps a wall second, from the first to the last."""
        return (self._steps - 1) / self._wall if self._wall > 0 else 0.0

    @property
    def _wall(self) -> float:
        return self._last - self._first if self._first is not None else 0.0
