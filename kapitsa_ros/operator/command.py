"""What the operator wants during one step."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Command:
    """What the operator wants during one step."""

    speed: float
    """Requested forcing speed, rad/s."""
    hold: float | None
    """Angle at which the pendulum is held, rad; None: it is let go, or stays free."""
    end: bool = False
    """The run is over before this step."""
