"""One state of the joints, as viewers are shown it."""

from __future__ import annotations

from typing import NamedTuple


class Frame(NamedTuple):
    """One state of the joints, `pivot` (m) and `pendulum` (rad)."""

    due: float
    """Wall time, s."""
    stamp_ns: int
    position: tuple[float, float]
    velocity: tuple[float, float]
