"""The stopwatch in the person's own hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.instruments.errors import InstrumentError
from kapitsa_ros.instruments.press_errors import display

if TYPE_CHECKING:
    from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings


class HandStopwatch:
    """One button: starts from zero, and stops.

    Parameters
    ----------
    settings
        Its `rate_error` and `display_resolution` are used; the press errors are the person's own.

    """

    def __init__(self, settings: StopwatchSettings) -> None:
        self._settings = settings
        self._started: float | None = None
        self._stopped: float | None = None

    @property
    def runs(self) -> bool:
        """Whether it has been started and not stopped."""
        return self._started is not None and self._stopped is None

    @property
    def started(self) -> float | None:
        """Simulated time of the press that started it, s; None where it stands at zero."""
        return self._started

    @property
    def gain(self) -> float:
        """Seconds it counts in a second."""
        return 1.0 + self._settings.rate_error

    @property
    def digit(self) -> float:
        """What its last digit is worth, s; 0: it can be read exactly."""
        return self._settings.display_resolution

    def press(self, now: float) -> None:
        """Press the button, at a simulated time, s.

        Raises
        ------
        InstrumentError
            It runs, and was started after that.

        """
        if self.runs and self._started is not None:
            if now < self._started:
                raise InstrumentError('not timed: the watch was started after that')
            self._stopped = now
        else:
            self._started, self._stopped = now, None

    def clear(self) -> None:
        """Set the display to zero."""
        self._started = self._stopped = None

    def shown(self, now: float) -> float:
        """Return what the display shows, s."""
        if self._started is None:
            return 0.0
        return display((now if self._stopped is None else self._stopped) - self._started, self._settings)
