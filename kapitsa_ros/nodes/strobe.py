"""The strobe: watches the pivot's mark and says what the dial reads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.instruments.settings import StrobeSettings
from kapitsa_ros.instruments.strobe import Strobe
from kapitsa_ros.nodes.instrument import InstrumentStage
from kapitsa_ros.nodes.parameters import declare_settings, settings_text
from kapitsa_ros.recording import topics
from kapitsa_ros.recording.messages import encode_strobe

if TYPE_CHECKING:
    from numpy.random import Generator


class StrobeNode(InstrumentStage):
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
