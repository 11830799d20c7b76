"""The strobe: watches the pivot's mark and says what the dial reads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.instruments.strobe import Strobe
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.network import topics
from kapitsa_ros.network.messages import encode_strobe
from kapitsa_ros.ros.instrument_node import InstrumentNode
from kapitsa_ros.ros.parameters import declare_settings, settings_text

if TYPE_CHECKING:
    from numpy.random import Generator


class StrobeNode(InstrumentNode):
    """Executable `strobe`."""

    encode = staticmethod(encode_strobe)

    def __init__(self) -> None:
        super().__init__('strobe', watches=topics.PIVOT, says=topics.STROBE)
        self._settings = declare_settings(self, StrobeSettings)
        self.latch_settings(settings_text('strobe', seed=self.seed, instrument=self._settings))

    def observer(self, chance: Generator) -> Strobe:
        """Return lamp, dial and eye."""
        return Strobe(self._settings, chance)


create = StrobeNode
