"""What viewers see, no more often than they can use."""

from __future__ import annotations

import time

PERIOD = 0.01
"""Seconds of wall time: a faster clock costs each of its readers a third of a core."""


REPORT_PERIOD = 0.5
"""Seconds of wall time between two reports of progress."""


class Throttle:
    """Lets one through a period of wall time."""

    def __init__(self, period: float = PERIOD) -> None:
        self._period = period
        self._last = -period

    def due(self) -> bool:
        """Whether the period has passed since this last said yes."""
        now = time.monotonic()
        if now - self._last < self._period:
            return False
        self._last = now
        return True
