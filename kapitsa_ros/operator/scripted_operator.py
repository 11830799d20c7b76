"""The person who carries out a protocol: sets the speed, holds and lets go, waits for both instruments."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.operator.command import Command

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kapitsa_ros.instruments.stopwatch import StopwatchReading
    from kapitsa_ros.instruments.strobe import StrobeReading
    from kapitsa_ros.operator.protocol import Protocol

PATIENCE = 120.0
"""Seconds of simulated time after which the operator gives up on a reading and ends the run."""
SWING = 10.0
"""Seconds more for each swing that is to be timed: slower ones nobody takes for a swing."""
CATCH = 0.5
"""Seconds for which the pendulum is held between two timings."""
FARTHER = 2.0
"""Factor of the release angle after a swing that friction stopped before it was timed."""
FARTHEST = 1.0
"""Release angle, rad, beyond which nobody would speak of small swings."""


class ScriptedOperator:
    """Commands of one run, one a step, each made from the readings of an earlier step.

    Parameters
    ----------
    protocol
        What to do.
    speeds
        Those of this run, rad/s.
    step
        Length of a communication step, s.

    """

    def __init__(self, protocol: Protocol, speeds: Sequence[float], step: float) -> None:
        self._release = protocol.release
        self._repeats = protocol.repeats
        self._speeds = tuple(speeds)
        self._patience = round((PATIENCE + SWING * protocol.swings) / step)
        self._catch = max(1, round(CATCH / step))
        self._script = self._perform()
        self._seen: tuple[StrobeReading | None, StopwatchReading | None] = (None, None)
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
        for speed in self._speeds:
            yield from self._until_read(0, Command(speed, self._release))
            for repeat in range(self._repeats):
                if repeat:
                    yield from [Command(speed, self._release)] * self._catch
                yield from self._time(speed)
        yield Command(self._speeds[-1], None, end=True)

    def _time(self, speed: float) -> Iterator[Command]:
        """Let go and wait for the stopwatch; where friction stops the swing too soon, let go from farther out."""
        angle = self._release
        while True:
            yield from self._until_read(1, Command(speed, None))
            reading = self._seen[1]
            angle *= FARTHER
            if reading is None or reading.kind != 'stopped' or abs(angle) > FARTHEST:
                return
            yield from [Command(speed, angle)] * self._catch

    def _until_read(self, instrument: int, command: Command) -> Iterator[Command]:
        """Repeat a command until the instrument gives a reading or patience ends."""
        for _ in range(self._patience):
            yield command
            if self._seen[instrument] is not None:
                return
