"""The person who carries out a protocol: sets the speed, holds and lets go, waits for both instruments."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kapitsa_ros.instruments.protocol import Protocol
    from kapitsa_ros.instruments.stopwatch import StopwatchReading
    from kapitsa_ros.instruments.strobe import StrobeReading

PATIENCE = 120.0
"""Seconds of simulated time after which the operator gives up on a reading and ends the run."""
CATCH = 0.5
"""Seconds for which the pendulum is held between two timings."""


@dataclass(frozen=True, slots=True)
class Command:
    """What the operator wants during one step."""

    speed: float
    """Forcing speed wanted, rad/s."""
    hold: float | None
    """Angle at which the pendulum is held, rad; None: it is let go, or stays free."""
    end: bool = False
    """The run is over before this step."""


class Operator:
    """Commands of one run, one a step, each made from the readings of an earlier step.

    Parameters
    ----------
    protocol
        What to do.
    speed
        The speed of this run, rad/s.
    step
        Length of a communication step, s.

    """

    def __init__(self, protocol: Protocol, speed: float, step: float) -> None:
        self._release = protocol.release
        self._repeats = protocol.repeats
        self._speed = speed
        self._patience = round(PATIENCE / step)
        self._catch = max(1, round(CATCH / step))
        self._script = self._perform()
        self._command = next(self._script)

    def opening(self) -> Command:
        """Return the command for the steps before the first reading can have an effect."""
        return self._command

    def command(self, strobe: StrobeReading | None, stopwatch: StopwatchReading | None) -> Command:
        """Return the command that follows from one step's readings (None: that instrument was silent)."""
        if not self._command.end:
            self._seen = (strobe, stopwatch)
            self._command = next(self._script)
        return self._command

    def _perform(self) -> Iterator[Command]:
        held = Command(self._speed, self._release)
        free = Command(self._speed, None)
        yield from self._until(0, held)
        for repeat in range(self._repeats):
            if repeat:
                yield from [held] * self._catch
            yield from self._until(1, free)
        yield Command(self._speed, None, end=True)

    def _until(self, instrument: int, command: Command) -> Iterator[Command]:
        """Repeat a command until the instrument gives a reading or patience ends."""
        for _ in range(self._patience):
            yield command
            if self._seen[instrument] is not None:
                return
