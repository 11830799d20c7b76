"""An instrument in the graph: watches one motion, and says now and then what it reads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from kapitsa_ros.configuration.rig_parameters import RigParameters
from kapitsa_ros.instruments.random_streams import random_stream
from kapitsa_ros.ros.parameters import declare_quantity
from kapitsa_ros.ros.step_node import StepNode

if TYPE_CHECKING:
    from numpy.random import Generator

    from kapitsa_ros.network.role import Role
    from kapitsa_ros.network.step import Step
    from kapitsa_ros.physics.sampled_motion import SampledMotion


class Instrument(Protocol):
    """An instrument together with the person who reads it."""

    def observe(self, start: float, motion: SampledMotion, /) -> Any:
        """Watch one step, which begins at `start` seconds of the run; return a reading or None."""


class InstrumentNode(StepNode):
    """Base of the nodes that read one motion and write one topic of readings.

    Parameters
    ----------
    role
        Its only topics are the motion and the readings.

    """

    def __init__(self, role: Role) -> None:
        super().__init__(role)
        self.seed = int(declare_quantity(self, RigParameters, 'seed'))
        (self._motion,), (self._readings,) = role.reads, role.writes
        self._instrument: Instrument

    def instrument(self, random: Generator) -> Instrument:
        """Return the instrument as it begins a run, with its stream of random numbers."""
        raise NotImplementedError

    def work(self, step: Step) -> None:
        """Watch one step."""
        if step.id.step == 0:
            self._instrument = self.instrument(random_stream(self.seed, self.role.name, step.id.run))
        reading = self._instrument.observe(step.start, step[self._motion])
        self.emit(self._readings, step.id, step.stamp_ns, reading)
