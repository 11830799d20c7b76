"""What a student hands in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from kapitsa_ros.units import RPM, parse_speed
from kapitsa_ros.web.errors import PageRequestError

_FASTEST = 100_000.0
"""RPM."""


@dataclass(frozen=True, kw_only=True)
class HandIn:
    """A critical speed with its interval, and the book that it rests on; RPM."""

    omega_crit_rpm: float
    low_rpm: float
    high_rpm: float
    when: str
    """ISO 8601."""
    readings: int
    """In the book that are not struck out."""
    book: str
    """CSV."""

    def covers(self, truth: float | None) -> bool | None:
        """Whether the interval holds a speed, RPM; None where there is none."""
        return None if truth is None else self.low_rpm <= truth <= self.high_rpm


def parse_hand_in(values: dict[str, Any]) -> tuple[float, float, float]:
    """Return critical speed and ends of the interval, RPM, of what a page sent by these names.

    Raises
    ------
    PageRequestError
        A value is no speed, or the interval does not hold the critical speed.

    """
    speeds = []
    for name in ('omega_crit_rpm', 'low_rpm', 'high_rpm'):
        try:
            speed = float(f'{parse_speed(values[name]) / RPM:.10g}')
        except (KeyError, ValueError) as error:
            raise PageRequestError('to hand in: a critical speed and both ends of its interval, RPM') from error
        if not 0.0 < speed <= _FASTEST:
            raise PageRequestError('to hand in: speeds above 0, at most {most:.0f} RPM', most=_FASTEST)
        speeds.append(speed)
    value, low, high = speeds
    if not low <= value <= high:
        raise PageRequestError('to hand in: the interval must hold the critical speed')
    return value, low, high
