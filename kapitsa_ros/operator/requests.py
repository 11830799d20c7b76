"""Requests of a person to the operator."""

from __future__ import annotations

import math

from kapitsa_ros.operator.errors import RequestError
from kapitsa_ros.units import RPM


def check_speed(speed: float, max_speed: float) -> None:
    """Check a forcing speed that is requested, rad/s, against the fastest the shaft can turn.

    Raises
    ------
    RequestError
        The shaft cannot turn so.

    """
    if not 0 <= speed <= max_speed:
        raise RequestError(
            'a speed of {asked:.6g} RPM ({speed:.6g} rad/s): the jigsaw does 0 to {rpm:.0f} RPM ({fastest:.6g} rad/s)',
            asked=speed / RPM,
            speed=speed,
            fastest=max_speed,
            rpm=max_speed / RPM,
        )


def check_release(angle: float) -> None:
    """Check an angle from which a release is requested, rad.

    Raises
    ------
    RequestError
        It is no angle above the horizontal.

    """
    if not abs(angle) < math.pi / 2:
        raise RequestError('a release from {angle} rad: give an angle within a quarter turn of upright', angle=angle)


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
        check_speed(speed, self._max_speed)
        self._speed = speed

    def ask_release(self, angle: float) -> None:
        """Ask that the pendulum be let go from an angle, rad.

        Raises
        ------
        RequestError
            It is no angle above the horizontal.

        """
        check_release(angle)
        self._angle = angle

    def take_speed(self) -> float | None:
        """Return the speed requested since the last call, if any."""
        speed, self._speed = self._speed, None
        return speed

    def take_release(self) -> float | None:
        """Return the angle requested since the last call, if any."""
        angle, self._angle = self._angle, None
        return angle
