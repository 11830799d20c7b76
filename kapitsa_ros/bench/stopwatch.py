"""The stopwatch in the person's own hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

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

    def press(self, now: float) -> None:
        """Press the button, at a simulated time, s."""
        if self.runs:
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
