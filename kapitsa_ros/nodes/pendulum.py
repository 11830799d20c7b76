"""The pendulum: answers the pivot's motion over a step with its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.network.registry import COMMAND, JIGSAW, MOTION, PENDULUM, PIVOT
from kapitsa_ros.network.settings import settings_topic
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.pendulum import Pendulum
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.ros.joint_state_publisher import JointStatePublisher
from kapitsa_ros.ros.model_publisher import ModelPublisher
from kapitsa_ros.ros.parameters import declare_set, settings_text
from kapitsa_ros.ros.settings_subscriber import SettingsSubscriber
from kapitsa_ros.ros.step_node import StepNode
from kapitsa_ros.schema import describe

if TYPE_CHECKING:
    from kapitsa_ros.network.step import Step


def load_kernels() -> None:
    """Load the kernels, which takes a third of a second: better before others count on this node."""
    Pendulum(Plant()).advance(SampledMotion(0.001, *np.zeros((3, 101))))


class PendulumNode(StepNode):
    """Executable `pendulum`."""

    def __init__(self) -> None:
        load_kernels()
        super().__init__(PENDULUM)
        # The stroke is the jigsaw's; the rest of the plant is declared here.
        self._plant = declare_set(self, Plant, *(item.name for item in describe(Plant) if item.name != 'amplitude'))
        self._pendulum = Pendulum(self._plant)
        self._joint_states = JointStatePublisher(self)
        self._model = ModelPublisher(self)
        self._settings_of_jigsaw = SettingsSubscriber(self, (JIGSAW.name,))
        self._is_described = False
        self.latch_settings(settings_text('pendulum', plant=self._plant))

    def work(self, step: Step) -> None:
        """Move on by one step."""
        if step.id.step == 0:
            self._pendulum = Pendulum(self._plant)
        hold = step[COMMAND].hold
        if hold is None:
            self._pendulum.release()
        else:
            self._pendulum.hold(hold)
        pivot = step[PIVOT]
        motion = self._pendulum.advance(pivot)
        self.emit(MOTION, step.id, step.stamp_ns, motion)
        self._joint_states.offer(step.stamp_ns, lambda: (pivot, motion))

    def pending(self) -> float:
        """Return the seconds until viewers are shown something."""
        return self._joint_states.wait()

    def poll(self) -> float:
        """Do what is due, and show viewers what is."""
        if self._settings_of_jigsaw.complete and not self._is_described:
            self._describe()
        return min(super().poll(), self._joint_states.refresh())

    def _describe(self) -> None:
        self._is_described = True
        stroke = self._settings_of_jigsaw.parsed()[JIGSAW.name].get('amplitude')
        try:
            self._model.publish(self._plant.replaced({'amplitude': stroke}))
        except (PhysicsError, TypeError) as error:
            self.refuse(f'{settings_topic(JIGSAW.name)}: {error}')


create = PendulumNode
