"""The work of a process for its nodes: each message as it comes, and what a node has to do when that is due."""

from __future__ import annotations

import math
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
        self.at_work = nodes[0]
        """The node that was called last: what is raised here is its."""

    @property
    def is_over(self) -> bool:
        """Whether all nodes have finished."""
        return all(node.finished for node in self._nodes)

    def poll(self) -> float:
        """Do what is due; return the seconds until the next call."""
        now = time.monotonic()
        for node in self._nodes:
            if not node.finished and node.due <= now:
                self.at_work = node
                node.due = math.inf  # what becomes due in the call is done by it
                node.due = time.monotonic() + node.poll()
        due = [node.due for node in self._nodes if not node.finished]
        return max(0.0, min(due) - time.monotonic()) if due else 0.0

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
