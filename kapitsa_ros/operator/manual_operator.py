"""The manual operator: turns a person's requests into commands."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kapitsa_ros.operator.command import Command
from kapitsa_ros.operator.scripted_operator import CATCH

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kapitsa_ros.instruments.stopwatch import StopwatchReading
    from kapitsa_ros.instruments.strobe import StrobeReading
    from kapitsa_ros.operator.requests import Requests

LONGEST = 80_000.0
"""Seconds after which a run is ended: each has a day of simulated time."""


class ManualOperator:
    """Commands of one run, one a step; it lasts until somebody ends it, or the day is over.

    The shaft is at rest and the pendulum held until something is requested. To let it go, the pendulum is caught, held
    at the angle for half a second, and released.

    Parameters
    ----------
    requests
        Where the requests are found.
    release
        Angle at which the pendulum is held until the first request, rad.
    step
        Length of a communication step, s.

    """

    def __init__(self, requests: Requests, release: float, step: float) -> None:
        self._requests = requests
        self._catch = max(1, round(CATCH / step))
        self._holds = self._hold(release)
        self._opening = Command(0.0, release)
        self._speed = 0.0
        self._left = round(LONGEST / step)

    def opening(self) -> Command:
        """Return the command for the steps before the first reading can have an effect."""
        return self._opening

    def command(self, strobe: StrobeReading | None, stopwatch: StopwatchReading | None) -> Command:  # noqa: ARG002
        """Return the command for the next free step; a person, not the operator, minds the readings."""
        self._left -= 1
        if self._left <= 0:
            return Command(0.0, None, end=True)
        speed = self._requests.take_speed()
        if speed is not None:
            self._speed = speed
        return Command(self._speed, next(self._holds))

    def _hold(self, angle: float) -> Iterator[float | None]:
        """Yield the angle at which the pendulum is held in each step, None where it is free."""
        held = math.inf
        while True:
            requested = self._requests.take_release()
            if requested is not None:
                angle, held = requested, self._catch
            yield angle if held > 0 else None
            held -= 1
