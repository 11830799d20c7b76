"""Collects a run step by step."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.run import Run

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kapitsa_ros.instruments.stopwatch import StopwatchReading
    from kapitsa_ros.instruments.strobe import StrobeReading
    from kapitsa_ros.operator.command import Command


@dataclass
class RunBuilder:
    """Collects a run step by step."""

    number: int
    settings: Mapping[str, Mapping[str, Any]]
    _speed: float = 0.0
    _release: float | None = None
    _speeds: list[StrobeReading] = field(default_factory=list)
    _timings: list[StopwatchReading] = field(default_factory=list)

    def add(self, command: Command, strobe: StrobeReading | None, stopwatch: StopwatchReading | None) -> None:
        """Take in one step: what was commanded for it, and what was read in it."""
        self._speed = command.speed
        if command.hold is not None:
            self._release = command.hold
        if strobe is not None:
            self._speeds.append(strobe)
        if stopwatch is not None:
            self._timings.append(stopwatch)

    def build(self, *, complete: bool) -> Run:
        """Return the run so far."""
        return Run(
            number=self.number,
            settings=self.settings,
            speed_asked=self._speed,
            release=self._release,
            speeds=tuple(self._speeds),
            timings=tuple(self._timings),
            complete=complete,
        )
