"""A timing: what one release came to, with all that the person knew of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal['timed', 'fell', 'stopped']
UNTIMED: dict[Kind, str] = {
    'fell': 'the rod fell over before its swings were timed',
    'stopped': 'friction brought the rod to rest before its swings were timed',
}
"""What happened at a release without a timing."""


@dataclass(frozen=True, kw_only=True)
class Timing:
    """What one release came to, SI units."""

    kind: Kind
    """Whether the swing was timed, the pendulum fell over, or it stopped before it was timed."""
    displayed: float
    """s on the display; 0 where nothing was timed to its end."""
    swings: int
    """Full swings the display stands for."""
    time: float
    """Seconds of the run at which it ended."""
    speed_asked: float | None
    """ω that was asked for while it lasted, rad/s; None where that was changed meanwhile."""
    speed_reading: float | None
    """ω read off the dial at that speed: the last reading before the end, else the first after it; None without one."""
    release: float | None
    """θ from which the pendulum was let go, rad; None where nobody held it."""
