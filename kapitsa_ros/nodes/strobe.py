"""The strobe: watches the pivot's mark and says what the dial reads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.instruments.randomness import stream
from kapitsa_ros.instruments.settings import StrobeSettings
from kapitsa_ros.instruments.strobe import Strobe
from kapitsa_ros.nodes import topics
from kapitsa_ros.nodes.conversions import decode_samples, encode_strobe, stamp_of
from kapitsa_ros.nodes.parameters import declare_seed, declare_settings, settings_text
from kapitsa_ros.nodes.stage import JoinedStage, ends_session, seconds_of_run

if TYPE_CHECKING:
    from kapitsa_ros.physics.steps import Tick


class StrobeNode(JoinedStage):
    """Executable `strobe`."""

    def __init__(self) -> None:
        super().__init__('strobe', reads=(topics.PIVOT,), writes=(topics.STROBE,))
        self._seed = declare_seed(self)
        self._settings = declare_settings(self, StrobeSettings)
        self._strobe = Strobe(self._settings, stream(self._seed, 'strobe', 1))
        self.latch_settings(settings_text('strobe', seed=self._seed, instrument=self._settings))

    def work(self, tick: Tick, messages: dict[str, bytes]) -> None:
        """Watch one step; a run has its own person and its own stream of chance."""
        raw = messages[topics.PIVOT.name]
        stamp = stamp_of(raw)
        if tick.end:
            self.emit_silence(topics.STROBE, tick, stamp)
            if ends_session(tick):
                self.finish()
            return
        if tick.step == 0:
            self._strobe = Strobe(self._settings, stream(self._seed, 'strobe', tick.run))
        reading = self._strobe.observe(seconds_of_run(stamp, tick), decode_samples(raw))
        self.emit(topics.STROBE, encode_strobe(stamp, tick, reading))


create = StrobeNode
