"""The stopwatch: watches the pendulum swing and says what the display shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.instruments.stopwatch import Stopwatch
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.network.registry import STOPWATCH
from kapitsa_ros.operator.protocol import Protocol
from kapitsa_ros.ros.instrument_node import InstrumentNode
from kapitsa_ros.ros.parameters import declare_quantity, declare_set, settings_text

if TYPE_CHECKING:
    from numpy.random import Generator


class StopwatchNode(InstrumentNode):
    """Executable `stopwatch`."""

    def __init__(self) -> None:
        super().__init__(STOPWATCH)
        self._swings = declare_quantity(self, Protocol, 'swings')
        self._settings = declare_set(self, StopwatchSettings, defaults=load_instruments('1997').stopwatch)
        self.latch_settings(settings_text('stopwatch', seed=self.seed, swings=self._swings, instrument=self._settings))

    def instrument(self, random: Generator) -> Stopwatch:
        """Return display, eye and thumb."""
        return Stopwatch(self._settings, self._swings, random)


create = StopwatchNode
