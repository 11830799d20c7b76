"""A dataflow node that acts on one message of each of its topics a step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.network.cdr import stamp_of
from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.network.step_id import StepId, ends_session
from kapitsa_ros.network.synchronizer import StepSynchronizer
from kapitsa_ros.ros.dataflow_node import IDLE, DataflowNode

if TYPE_CHECKING:
    from kapitsa_ros.network.topics import Topic


class StepNode(DataflowNode):
    """A stage that acts on one message of each of its topics a step.

    Parameters
    ----------
    name, reads, writes
        As for `DataflowNode`.
    follows
        Those of `reads` whose writer may run ahead of the end of a run; see `StepSynchronizer`.

    """

    def __init__(
        self, name: str, *, reads: tuple[Topic, ...], writes: tuple[Topic, ...], follows: tuple[Topic, ...] = ()
    ) -> None:
        super().__init__(name, reads=reads, writes=writes)
        self._join = StepSynchronizer(
            [topic.name for topic in self.reads if topic not in follows],
            [topic.name for topic in self.reads if topic in follows],
        )

    def work(self, step_id: StepId, messages: dict[str, bytes]) -> None:
        """Do one step; called in order, with the message of each topic."""
        raise NotImplementedError

    def end_run(self, step_id: StepId, stamp_ns: int, messages: dict[str, bytes]) -> None:  # noqa: ARG002
        """Pass the end of a run on; called in place of `work`, with the messages of the topics that lead."""
        for topic in self.writes:
            self.emit_silence(topic, step_id, stamp_ns)

    def accept(self, topic: str, step_id: StepId, raw: bytes) -> bool:
        """Queue the message."""
        return self._join.put(topic, step_id, raw)

    def advance(self) -> float:
        """Do all steps that are complete."""
        while not self.finished and (step := self._join.take()) is not None:
            step_id, messages = step
            if step_id.end:
                self.end_run(step_id, stamp_of(next(iter(messages.values()))), messages)
                if ends_session(step_id):
                    self.finish()
            else:
                self.work(step_id, messages)
        return IDLE


def seconds_of_run(stamp_ns: int, step_id: StepId) -> float:
    """Return the seconds of the run at a stamp."""
    return (stamp_ns - step_id.run * DAY) / SECOND
