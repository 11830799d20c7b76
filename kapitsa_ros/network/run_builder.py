"""Collects a run step by step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.registry import READINGS, STOPWATCH_READING, STROBE_READING, writer_of
from kapitsa_ros.network.run import Run
from kapitsa_ros.network.timing import Timing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kapitsa_ros.instruments.stopwatch import StopwatchReading
    from kapitsa_ros.instruments.strobe import StrobeReading
    from kapitsa_ros.network.topic import Topic
    from kapitsa_ros.operator.command import Command


class RunBuilder:
    """Collects a run step by step, and tells which speed, dial reading and release each timing belongs to.

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
        self._span = 0
        self._let_go_in: int | None = None
        self._dial: dict[int, list[StrobeReading]] = {}
        self._ends: list[_End] = []
        self._readings: dict[Topic[Any], list[Any]] = {topic: [] for topic in READINGS}

    def add(self, command: Command, readings: Mapping[Topic[Any], Any]) -> None:
        """Take in one step: what was commanded for it, and what was read in it (None: nothing)."""
        if command.speed != self._speed:
            self._speed = command.speed
            self._span += 1
        if command.hold is not None:
            self._release = command.hold
            self._let_go_in = None
        elif self._let_go_in is None:
            self._let_go_in = self._span
        for topic, reading in readings.items():
            if reading is not None:
                self._readings[topic].append(reading)
        if (dial := readings.get(STROBE_READING)) is not None:
            self._dial.setdefault(self._span, []).append(dial)
        if (watch := readings.get(STOPWATCH_READING)) is not None:
            unchanged = self._let_go_in == self._span
            self._ends.append(_End(watch, self._span if unchanged else None, self._speed, self._release))

    def build(self, *, complete: bool) -> Run:
        """Return the run so far."""
        return Run(
            number=self.number,
            settings=self.settings,
            speed_asked=self._speed,
            release=self._release,
            readings={writer_of(topic).name: tuple(found) for topic, found in self._readings.items()},
            timings=tuple(self._timing(end) for end in self._ends),
            complete=complete,
        )

    def _timing(self, end: _End) -> Timing:
        dial = [] if end.span is None else self._dial.get(end.span, [])
        before = [reading for reading in dial if reading.time <= end.reading.pressed_at]
        read = before[-1:] or dial[:1]
        return Timing(
            kind=end.reading.kind,
            displayed=end.reading.displayed,
            swings=end.reading.swings,
            time=end.reading.pressed_at,
            speed_asked=None if end.span is None else end.speed,
            speed_reading=read[0].speed if read else None,
            release=end.release,
        )


@dataclass(frozen=True)
class _End:
    """The end of a timing, as it was read."""

    reading: StopwatchReading
    span: int | None
    """Number of the span of one speed asked within which it took place; None where it took place in no single one."""
    speed: float
    release: float | None
