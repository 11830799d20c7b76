"""The work of a process for its nodes: each message as it comes, and what a node has to do when that is due."""

from __future__ import annotations

import time
from contextlib import ExitStack
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.ros.process_node import ProcessNode


class NodeLoop:
    """What the nodes of a process do in one thread: with one for each they would only wait for Python's lock.

    Parameters
    ----------
    nodes
        One or more, all in one executor.

    """

    def __init__(self, nodes: Sequence[ProcessNode]) -> None:
        self._nodes = nodes
        self._due = dict.fromkeys(nodes, 0.0)
        """Those that have not finished, and when each has to be polled, s of the steady clock."""
        self.at_work = nodes[0]
        """The node that was called last: what is raised here is its."""

    @property
    def is_over(self) -> bool:
        """Whether all nodes have finished."""
        return not self._due

    def poll(self) -> float:
        """Do what is due; return the seconds until the next call."""
        now = time.monotonic()
        heard = [node for node in self._due if node.heard]
        for node in heard:
            node.heard = False
            self._due[node] = min(self._due[node], now + node.wait)
            if node.finished:
                del self._due[node]
        # Where it was no message, a service or a time-out woke the executor: anybody's.
        due = [node for node, at in self._due.items() if at <= now or not heard]
        if due:
            for node in due:
                self.at_work = node
                self._due[node] = now + node.poll()
                if node.finished:
                    del self._due[node]
            now = time.monotonic()
        return max(0.0, min(self._due.values()) - now) if self._due else 0.0

    def close(self) -> None:
        """Close all nodes, also where one of them fails in it."""
        with ExitStack() as closing:
            for node in self._nodes:
                closing.callback(self._close, node)

    def _close(self, node: ProcessNode) -> None:
        try:
            node.close()
        except Exception:
            self.at_work = node
            raise
