"""The dial of the lamp, as a hand turns it and an eye reads it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from kapitsa_ros.instruments.strobe_settings import StrobeSettings

FINE = 5
"""A touch of the dial is this part of a graduation."""
TOUCH = 1.0
"""The same of a dial without graduations, flashes a minute."""


@dataclass(frozen=True)
class LampDial:
    """The dial of a lamp; flashes a minute."""

    settings: StrobeSettings

    @property
    def graduation(self) -> float:
        """Distance of two graduations; 0: it can be read exactly."""
        return self.settings.dial_resolution / RPM

    @property
    def end(self) -> float:
        """How far it goes."""
        return self.settings.dial_end / RPM

    @property
    def touch(self) -> float:
        """The least that a hand turns it."""
        return self.graduation / FINE or TOUCH
