"""The operator at a person's beck and call: turns what is asked for into commands."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kapitsa_ros.instruments.errors import RequestError
from kapitsa_ros.instruments.operator import CATCH, Command
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kapitsa_ros.instruments.stopwatch import StopwatchReading
    from kapitsa_ros.instruments.strobe import StrobeReading

LONGEST = 80_000.0
"""Seconds after which a run is ended: each has a day of simulated time."""


class Requests:
    """What a person asks for; of several requests between two steps the newest counts.

    Parameters
    ----------
    max_speed
        Fastest the shaft can turn, rad/s.

    """

    def __init__(self, max_speed: float) -> None:
        self._max_speed = max_speed
        self._speed: float | None = None
        self._angle: float | None = None

    def ask_speed(self, speed: float) -> None:
        """Ask for a forcing speed, rad/s.

        Raises
        ------
        RequestError
            The shaft cannot turn so.

        """
        if not 0 <= speed <= self._max_speed:
            raise RequestError(
                f'a speed of {speed} rad/s: the jigsaw does 0 to {self._max_speed:.6g} rad/s '
                f'({self._max_speed / RPM:.0f} RPM)'
            )
        self._speed = speed

    def ask_release(self, angle: float) -> None:
        """Ask that the pendulum be let go from an angle, rad.

        Raises
        ------
        RequestError
            It is no angle above the horizontal.

        """
        if not abs(angle) < math.pi / 2:
            raise RequestError(f'a release from {angle} rad: give an angle within a quarter turn of upright')
        self._angle = angle

    def take_speed(self) -> float | None:
        """Return the speed asked for since the last call, if any."""
        speed, self._speed = self._speed, None
        return speed

    def take_release(self) -> float | None:
        """Return the angle asked for since the last call, if any."""
        angle, self._angle = self._angle, None
        return angle


class ManualOperator:
    """Commands of one run, one a step; it lasts until somebody ends it, or the day is over.

    The shaft is at rest and the pendulum held until something is asked for. To let it go, the pendulum is caught, held
    at the angle for half a second, and released.

    Parameters
    ----------
    requests
        Where what is asked for is found.
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
            asked = self._requests.take_release()
            if asked is not None:
                angle, held = asked, self._catch
            yield angle if held > 0 else None
            held -= 1
