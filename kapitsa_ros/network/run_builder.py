"""Collects a run step by step."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.registry import READINGS, writer_of
from kapitsa_ros.network.run import Run

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kapitsa_ros.network.topic import Topic
    from kapitsa_ros.operator.command import Command


class RunBuilder:
    """Collects a run step by step.

    Parameters
    ----------
    number
        Of the run.
    settings
        By role, as each that describes the run published it.

    """

    def __init__(self, number: int, settings: Mapping[str, Mapping[str, Any]]) -> None:
        self.number = number
        self.settings = settings
        self._speed = 0.0
        self._release: float | None = None
        self._readings: dict[Topic[Any], list[Any]] = {topic: [] for topic in READINGS}

    def add(self, command: Command, readings: Mapping[Topic[Any], Any]) -> None:
        """Take in one step: what was commanded for it, and what was read in it (None: nothing)."""
        self._speed = command.speed
        if command.hold is not None:
            self._release = command.hold
        for topic, reading in readings.items():
            if reading is not None:
                self._readings[topic].append(reading)

    def build(self, *, complete: bool) -> Run:
        """Return the run so far."""
        return Run(
            number=self.number,
            settings=self.settings,
            speed_asked=self._speed,
            release=self._release,
            readings={writer_of(topic).name: tuple(found) for topic, found in self._readings.items()},
            complete=complete,
        )
