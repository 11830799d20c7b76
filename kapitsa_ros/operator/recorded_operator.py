"""An operator who does once more what was commanded in a recorded run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.operator.command import Command

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kapitsa_ros.instruments.stopwatch import StopwatchReading
    from kapitsa_ros.instruments.strobe import StrobeReading


class RecordedOperator:
    """Gives the commands of a recorded run, one a step, and then ends the run; looks at no reading.

    Parameters
    ----------
    commands
        In the order of the steps.

    """

    def __init__(self, commands: Iterable[Command]) -> None:
        self._commands = iter(commands)

    def opening(self) -> Command:
        """Return the command of a step that no reading comes before."""
        return next(self._commands, Command(0.0, None))

    def command(self, _strobe: StrobeReading | None, _stopwatch: StopwatchReading | None) -> Command:
        """Return the command of the next step; after the last, that the run is over."""
        return next(self._commands, Command(0.0, None, end=True))
