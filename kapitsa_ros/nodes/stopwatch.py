"""The stopwatch: watches the pendulum swing and says what the display shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.instruments.settings import StopwatchSettings
from kapitsa_ros.instruments.stopwatch import Stopwatch
from kapitsa_ros.nodes.instrument import InstrumentStage
from kapitsa_ros.nodes.parameters import declare, declare_settings, settings_text
from kapitsa_ros.recording import topics
from kapitsa_ros.recording.messages import encode_stopwatch

if TYPE_CHECKING:
    from numpy.random import Generator


class StopwatchNode(InstrumentStage):
    """Executable `stopwatch`."""

    encode = staticmethod(encode_stopwatch)

    def __init__(self) -> None:
        super().__init__('stopwatch', watches=topics.MOTION, says=topics.STOPWATCH)
        self._swings = declare(self, 'swings', 3, 'full swings timed after each release', 1, 1000)
        self._settings = declare_settings(self, StopwatchSettings)
        self.latch_settings(settings_text('stopwatch', seed=self.seed, swings=self._swings, instrument=self._settings))

    def observer(self, chance: Generator) -> Stopwatch:
        """Return display, eye and thumb."""
        return Stopwatch(self._settings, self._swings, chance)


create = StopwatchNode
