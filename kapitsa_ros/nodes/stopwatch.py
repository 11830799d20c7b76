"""The stopwatch: watches the pendulum swing and says what the display shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.instruments.randomness import stream
from kapitsa_ros.instruments.settings import StopwatchSettings
from kapitsa_ros.instruments.stopwatch import Stopwatch
from kapitsa_ros.nodes import topics
from kapitsa_ros.nodes.conversions import decode_samples, encode_stopwatch, stamp_of
from kapitsa_ros.nodes.parameters import declare, declare_seed, declare_settings, settings_text
from kapitsa_ros.nodes.stage import JoinedStage, ends_session, seconds_of_run

if TYPE_CHECKING:
    from kapitsa_ros.physics.steps import Tick


class StopwatchNode(JoinedStage):
    """Executable `stopwatch`."""

    def __init__(self) -> None:
        super().__init__('stopwatch', reads=(topics.MOTION,), writes=(topics.STOPWATCH,))
        self._seed = declare_seed(self)
        self._swings = declare(self, 'swings', 3, 'full swings timed after each release', 1, 1000)
        self._settings = declare_settings(self, StopwatchSettings)
        self._stopwatch = self._for_run(1)
        self.latch_settings(
            settings_text('stopwatch', seed=self._seed, swings=self._swings, instrument=self._settings)
        )

    def work(self, tick: Tick, messages: dict[str, bytes]) -> None:
        """Watch one step; a run has its own person and its own stream of chance."""
        raw = messages[topics.MOTION.name]
        stamp = stamp_of(raw)
        if tick.end:
            self.emit_silence(topics.STOPWATCH, tick, stamp)
            if ends_session(tick):
                self.finish()
            return
        if tick.step == 0:
            self._stopwatch = self._for_run(tick.run)
        reading = self._stopwatch.observe(seconds_of_run(stamp, tick), decode_samples(raw))
        self.emit(topics.STOPWATCH, encode_stopwatch(stamp, tick, reading))

    def _for_run(self, run: int) -> Stopwatch:
        return Stopwatch(self._settings, self._swings, stream(self._seed, 'stopwatch', run))


create = StopwatchNode
