"""The pendulum: answers the pivot's motion over a step with its own."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.network import topics
from kapitsa_ros.network.cdr import stamp_of
from kapitsa_ros.network.messages import decode_command, decode_samples, encode_samples
from kapitsa_ros.physics.pendulum import Pendulum
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.ros.joint_state_publisher import JointStatePublisher
from kapitsa_ros.ros.parameters import declare_plant, settings_text
from kapitsa_ros.ros.step_node import StepNode

if TYPE_CHECKING:
    from kapitsa_ros.network.step_id import StepId


class PendulumNode(StepNode):
    """Executable `pendulum`."""

    def __init__(self) -> None:
        # Kernels take a third of a second to load: better now, before others count on this node.
        Pendulum(Plant()).advance(SampledMotion(0.001, *np.zeros((3, 101))))
        super().__init__(
            'pendulum', reads=(topics.PIVOT, topics.COMMAND), writes=(topics.MOTION,), follows=(topics.COMMAND,)
        )
        # The stroke is the jigsaw's; all else of the plant is here.
        self._plant = declare_plant(self, *(field.name for field in fields(Plant) if field.name != 'amplitude'))
        self._pendulum = Pendulum(self._plant)
        self._screen = JointStatePublisher(self)
        self.latch_settings(settings_text('pendulum', plant=self._plant))

    def work(self, step_id: StepId, messages: dict[str, bytes]) -> None:
        """Move on by one step."""
        pivot = messages[topics.PIVOT.name]
        if step_id.step == 0:
            self._pendulum = Pendulum(self._plant)
        hold = decode_command(messages[topics.COMMAND.name]).hold
        if hold is None:
            self._pendulum.release()
        else:
            self._pendulum.hold(hold)
        shaken = decode_samples(pivot)
        motion = self._pendulum.advance(shaken)
        self.emit(topics.MOTION, encode_samples(stamp_of(pivot), step_id, 'pendulum', motion))
        self._screen.offer(stamp_of(pivot), lambda: (shaken, motion))

    def poll(self) -> float:
        """Do what is due, and show viewers what is."""
        return min(super().poll(), self._screen.refresh())


create = PendulumNode
