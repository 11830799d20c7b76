"""Brings the messages of one step together.

A node of a Kahn network acts when it has its inputs for a step, and on nothing else: then its output depends on the
content of the messages alone, however they were scheduled.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from kapitsa_ros.network.errors import SequenceError
from kapitsa_ros.network.step import Step

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kapitsa_ros.network.step_id import StepId

    _Queue = deque[tuple[int, StepId, bytes]]


class StepSynchronizer:
    """Numbered messages of several topics, taken out a step at a time.

    Parameters
    ----------
    leading
        Topics that carry every step of a run and its end.
    following
        Topics whose writer may run ahead of the end of a run: its messages beyond the end are dropped.

    """

    def __init__(self, leading: Iterable[str], following: Iterable[str] = ()) -> None:
        self._leading: dict[str, _Queue] = {topic: deque() for topic in leading}
        self._following: dict[str, _Queue] = {topic: deque() for topic in following}
        self._queues = self._leading | self._following
        self._last: dict[str, StepId] = {}
        self._runs = dict.fromkeys(self._queues, 0)

    def put(self, topic: str, step_id: StepId, raw: bytes) -> bool:
        """Take a message in; return False if its step has been seen before.

        Raises
        ------
        SequenceError
            Steps are missing before this one.

        """
        last = self._last.get(topic)
        if (
            last is not None
            and step_id.run == last.run
            and step_id.step <= last.step
            and not (last.end and step_id.step == 0)
        ):
            return False
        opens_next = topic in self._following and step_id.step == 0
        if not (step_id.follows(last) or opens_next):
            if last is None:
                raise SequenceError(f'joined late: {topic} is at {step_id}; a role is taken before a run begins')
            raise SequenceError(f'gap on {topic}: {step_id} came after {last}')
        self._last[topic] = step_id
        self._runs[topic] += step_id.step == 0
        self._queues[topic].append((self._runs[topic], step_id, raw))
        return True

    def take(self) -> Step | None:
        """Return the next step and its message on each topic, or None while one is missing.

        With the end of a run come the messages of the leading topics only.
        """
        if not all(self._leading.values()):
            return None
        heads = {topic: queue[0] for topic, queue in self._leading.items()}
        run, step_id, _ = next(iter(heads.values()))
        if any(head[1] != step_id for head in heads.values()):
            raise SequenceError(
                f'topics disagree: {", ".join(f"{topic} is at {head[1]}" for topic, head in heads.items())}'
            )
        # Runs are distinguished by their order, not by their number: bags may be played in any order.
        after = (run + 1, 0) if step_id.end else (run, step_id.step)
        for queue in self._following.values():
            while queue and (queue[0][0], queue[0][1].step) < after:
                queue.popleft()
        queues = self._leading if step_id.end else self._queues
        if not all(queue and (step_id.end or queue[0][1] == step_id) for queue in queues.values()):
            return None
        return Step(step_id, {topic: queue.popleft()[2] for topic, queue in queues.items()})
