"""One run as the operator saw it: commands and readings, without the motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.errors import RunError
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.plant import Plant

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kapitsa_ros.instruments.stopwatch import StopwatchReading
    from kapitsa_ros.instruments.strobe import StrobeReading


@dataclass(frozen=True, eq=False)
class Run:
    """A run: its settings and its readings; bag and live graph build the same from the same messages."""

    number: int
    settings: Mapping[str, Mapping[str, Any]]
    """By role, as each that describes the run published it."""
    speed_asked: float
    """rad/s, of the last command."""
    release: float | None
    """Angle at which the pendulum was last held, rad; None: it never was."""
    readings: Mapping[str, tuple[Any, ...]]
    """What each instrument read, by role, in the order of the steps."""
    complete: bool
    """Whether the end of the run was seen."""

    @property
    def speeds(self) -> tuple[StrobeReading, ...]:
        """Readings of the strobe."""
        return self.readings.get('strobe', ())

    @property
    def timings(self) -> tuple[StopwatchReading, ...]:
        """Readings of the stopwatch."""
        return self.readings.get('stopwatch', ())

    @property
    def plant(self) -> Plant:
        """The plant that was simulated, or as the drivers of a real rig describe it.

        Raises
        ------
        RunError
            The settings do not describe a plant.

        """
        try:
            plant = {**self.settings['pendulum']['plant'], 'amplitude': self.settings['jigsaw']['amplitude']}
            return Plant(**plant)
        except (KeyError, TypeError, PhysicsError) as error:
            raise RunError(f'run {self.number}: its settings do not describe a plant ({error})') from error

    @property
    def speed_reading(self) -> float | None:
        """The last reading of the strobe, rad/s; None where there was none."""
        return self.speeds[-1].speed if self.speeds else None

    @property
    def period(self) -> float | None:
        """Mean period of the slow swing over all timings that came to their end, s; None where none did."""
        timed = [reading.displayed / reading.swings for reading in self.timings if reading.kind == 'timed']
        return sum(timed) / len(timed) if timed else None

    @property
    def fell(self) -> bool:
        """Whether the pendulum was seen to fall over."""
        return any(reading.kind == 'fell' for reading in self.timings)
