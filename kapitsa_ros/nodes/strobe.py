"""The strobe: watches the pivot's mark and says what the dial reads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.instruments.strobe import Strobe
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.network.registry import STROBE
from kapitsa_ros.ros.instrument_node import InstrumentNode
from kapitsa_ros.ros.parameters import declare_set, settings_text

if TYPE_CHECKING:
    from numpy.random import Generator


class StrobeNode(InstrumentNode):
    """Executable `strobe`."""

    def __init__(self) -> None:
        super().__init__(STROBE)
        self._settings = declare_set(self, StrobeSettings, defaults=load_instruments('1997').strobe)
        self.latch_settings(settings_text('strobe', seed=self.seed, instrument=self._settings))

    def instrument(self, random: Generator) -> Strobe:
        """Return lamp, dial and eye."""
        return Strobe(self._settings, random)


create = StrobeNode
