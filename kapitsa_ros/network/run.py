"""One run as the operator saw it: commands and readings, without the motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.errors import RunError
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.plant import Plant

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kapitsa_ros.instruments.strobe import StrobeReading
    from kapitsa_ros.network.timing import Timing


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
    timings: tuple[Timing, ...]
    """What each release came to, in order."""
    complete: bool
    """Whether the end of the run was seen."""

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
        speeds: tuple[StrobeReading, ...] = self.readings.get('strobe', ())
        return speeds[-1].speed if speeds else None

    @property
    def period(self) -> float | None:
        """Period of the slow swing as read, s: of the timings at the speed of the last one; None where none was timed.

        By least squares, as the person would who adds up displays and swings of equal timings.
        """
        timed = [timing for timing in self.timings if timing.kind == 'timed' and timing.swings > 0]
        same = [timing for timing in timed if timing.speed_asked == timed[-1].speed_asked]
        if not same:
            return None
        most = max(each.swings for each in same)
        weights = [each.swings / most for each in same]
        displayed = sum(weight * each.displayed for weight, each in zip(weights, same, strict=True))
        return displayed / sum(weight * each.swings for weight, each in zip(weights, same, strict=True))

    @property
    def fell(self) -> bool:
        """Whether the pendulum was seen to fall over."""
        return any(timing.kind == 'fell' for timing in self.timings)
