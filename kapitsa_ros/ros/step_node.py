"""A dataflow node that acts on one message of each of its topics a step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.network.step_id import StepId, ends_session
from kapitsa_ros.network.synchronizer import StepSynchronizer
from kapitsa_ros.ros.dataflow_node import IDLE, DataflowNode

if TYPE_CHECKING:
    from kapitsa_ros.network.role import Role
    from kapitsa_ros.network.step import Step


class StepNode(DataflowNode):
    """A node that acts when it has its inputs for a step, and on nothing else.

    Parameters
    ----------
    role
        Which of its topics may run ahead of the end of a run, `follows` says.

    """

    def __init__(self, role: Role) -> None:
        super().__init__(role)
        self._synchronizer = StepSynchronizer(
            [topic.name for topic in self.reads if topic not in role.follows],
            [topic.name for topic in self.reads if topic in role.follows],
        )

    def work(self, step: Step) -> None:
        """Do one step; called in order, with the values of all topics."""
        raise NotImplementedError

    def end_run(self, step: Step) -> None:
        """Pass the end of a run on; called in place of `work`, with the messages of the leading topics alone."""
        for topic in self.writes:
            self.emit_silence(topic, step.id, step.stamp_ns)

    def accept(self, topic: str, step_id: StepId, raw: bytes) -> bool:
        """Queue the message."""
        return self._synchronizer.put(topic, step_id, raw)

    def advance(self) -> float:
        """Do all steps that are complete."""
        while not self.finished and (step := self._synchronizer.take()) is not None:
            if step.id.end:
                self.end_run(step)
                if ends_session(step.id):
                    self.finish()
            else:
                self.work(step)
        return IDLE
