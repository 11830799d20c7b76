"""The pendulum: answers the pivot's motion over a step with its own."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.nodes.parameters import declare_plant, settings_text
from kapitsa_ros.nodes.screen import Screen
from kapitsa_ros.nodes.stage import JoinedStage
from kapitsa_ros.physics.parameters import PlantParameters
from kapitsa_ros.physics.plant import Pendulum
from kapitsa_ros.physics.samples import Samples
from kapitsa_ros.recording import topics
from kapitsa_ros.recording.messages import decode_command, decode_samples, encode_samples
from kapitsa_ros.recording.wire import stamp_of

if TYPE_CHECKING:
    from kapitsa_ros.physics.steps import Tick


class PendulumNode(JoinedStage):
    """Executable `pendulum`."""

    def __init__(self) -> None:
        # Kernels take a third of a second to load: better now, before others count on this node.
        Pendulum(PlantParameters()).advance(Samples(0.001, *np.zeros((3, 101))))
        super().__init__(
            'pendulum', reads=(topics.PIVOT, topics.COMMAND), writes=(topics.MOTION,), follows=(topics.COMMAND,)
        )
        # The stroke is the jigsaw's; all else of the plant is here.
        self._plant = declare_plant(
            self, *(field.name for field in fields(PlantParameters) if field.name != 'amplitude')
        )
        self._pendulum = Pendulum(self._plant)
        self._screen = Screen(self)
        self.latch_settings(settings_text('pendulum', plant=self._plant))

    def work(self, tick: Tick, messages: dict[str, bytes]) -> None:
        """Move on by one step."""
        pivot = messages[topics.PIVOT.name]
        if tick.step == 0:
            self._pendulum = Pendulum(self._plant)
        hold = decode_command(messages[topics.COMMAND.name]).hold
        if hold is None:
            self._pendulum.release()
        else:
            self._pendulum.hold(hold)
        shaken = decode_samples(pivot)
        motion = self._pendulum.advance(shaken)
        self.emit(topics.MOTION, encode_samples(stamp_of(pivot), tick, 'pendulum', motion))
        self._screen.offer(stamp_of(pivot), lambda: (shaken, motion))

    def poll(self) -> float:
        """Do what is due, and show viewers what is."""
        return min(super().poll(), self._screen.refresh())


create = PendulumNode
