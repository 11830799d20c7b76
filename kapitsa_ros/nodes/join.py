"""Brings the messages of one step together.

A node of a Kahn network acts when it has its inputs for a step, and on nothing else: then its output depends on the
content of the messages alone, however they were scheduled.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from kapitsa_ros.nodes.errors import SequenceError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kapitsa_ros.physics.steps import Tick


class Join:
    """Numbered messages of several topics, taken out a step at a time.

    Parameters
    ----------
    leading
        Topics that carry every step of a run and its end.
    following
        Topics whose writer may run ahead of the end of a run: what it said beyond the end is dropped.

    """

    def __init__(self, leading: Iterable[str], following: Iterable[str] = ()) -> None:
        self._leading: dict[str, deque[tuple[Tick, bytes]]] = {topic: deque() for topic in leading}
        self._following: dict[str, deque[tuple[Tick, bytes]]] = {topic: deque() for topic in following}
        self._last: dict[str, Tick] = {}

    def put(self, topic: str, tick: Tick, raw: bytes) -> bool:
        """Take a message in; return False if its step has been seen before.

        Raises
        ------
        SequenceError
            Steps are missing before this one.

        """
        last = self._last.get(topic)
        if last is not None and (tick.run, tick.step) <= (last.run, last.step):
            return False
        runs_ahead = topic in self._following and last is not None and tick.run == last.run + 1 and tick.step == 0
        if not (tick.follows(last) or runs_ahead):
            if last is None:
                raise SequenceError(f'joined late: {topic} is at {tick}; a role is taken before the run begins, or after a reset')
            raise SequenceError(f'gap on {topic}: {tick} came after {last}')
        self._last[topic] = tick
        queue = self._leading.get(topic)
        (self._following[topic] if queue is None else queue).append((tick, raw))
        return True

    def take(self) -> tuple[Tick, dict[str, bytes]] | None:
        """Return the next step and its message on each topic, or None while one is missing.

        With the end of a run come the messages of the leading topics only.
        """
        if not all(self._leading.values()):
            return None
        ticks = {queue[0][0] for queue in self._leading.values()}
        if len(ticks) != 1:
            raise SequenceError(f'topics disagree: {", ".join(f"{topic} is at {queue[0][0]}" for topic, queue in self._leading.items())}')
        (tick,) = ticks
        beyond = (tick.run + 1, 0) if tick.end else (tick.run, tick.step)
        for queue in self._following.values():
            while queue and (queue[0][0].run, queue[0][0].step) < beyond:
                queue.popleft()
        queues = dict(self._leading)
        if not tick.end:
            if not all(queue and queue[0][0] == tick for queue in self._following.values()):
                return None
            queues |= self._following
        return tick, {topic: queue.popleft()[1] for topic, queue in queues.items()}
