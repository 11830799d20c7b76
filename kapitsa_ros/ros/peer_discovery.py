"""Who else has to be there before the first step."""

from __future__ import annotations

import shutil
import time
from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.registry import readers_of, writer_of
from kapitsa_ros.ros.errors import NodeError
from kapitsa_ros.ros.node_names import node_names

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from rclpy.node import Node

    from kapitsa_ros.network.topic import Topic

LOST = 3.0
"""Seconds for which a peer has been out of reach when it is given up; DDS waits for 20 s before it tells of that."""
PATIENCE = 3.0
"""Seconds before the first line about who is missing; each next one comes after twice the time."""


class PeerDiscovery:
    """Watches the graph until every expected reader and writer of this node's topics is matched.

    Holding back the first message is all it takes: in a dataflow network a late message changes nothing.
    """

    def __init__(
        self, node: Node, writes: Iterable[Topic[Any]], reads: Iterable[Topic[Any]], expected: frozenset[str]
    ) -> None:
        self._node = node
        self._writes = {topic: readers_of(topic) & expected for topic in writes}
        self._reads = tuple(reads)
        self._resolved = {topic.name: node.resolve_topic_name(topic.name) for topic in (*self._writes, *self._reads)}
        """Names on the graph, by names of topics: they may be remapped."""
        self._next_line = time.monotonic() + PATIENCE
        self._wait = PATIENCE
        self.matched = False
        self._lost_since: float | None = None

    def ready(self) -> bool:
        """Whether everyone is there; says who is missing, at growing intervals.

        Raises
        ------
        NodeError
            Someone else has this node's role: the domain is taken.

        """
        if self.matched:
            return True
        self._refuse_doubles()
        missing = self._missing()
        if not missing:
            self.matched = True
            if self._wait > PATIENCE:  # whoever has read for whom it waits has to know that it no longer does
                self._node.get_logger().info('waits for nobody any more')
        elif time.monotonic() > self._next_line:
            self._wait *= 2
            self._next_line = time.monotonic() + self._wait
            domain = self._node.context.get_domain_id()
            start = 'ros2 run kapitsa_ros' if shutil.which('ros2') else 'kapitsa node'
            self._node.get_logger().info(
                f'waiting for {", ".join(sorted(missing))} in domain {domain}: start with `{start} NAME`'
            )
        return self.matched

    def refuse_lost(self, over: Collection[str], *, heard: bool) -> None:
        """Look whether everyone whom this node reads still is there; called now and then.

        Who only reads may leave: it was through before this node, and where it was not, those it writes to miss it.

        Parameters
        ----------
        over
            Topics on which it was said that no run follows: their writers may leave.
        heard
            Whether a message came since the last call: then what a lost one said last may still be on its way.

        Raises
        ------
        NodeError
            Someone has been out of reach for too long.

        """
        lost = set() if heard else self._unwritten(over)
        now = time.monotonic()
        if not lost:
            self._lost_since = None
        elif self._lost_since is None:
            self._lost_since = now
        elif now - self._lost_since > LOST:
            raise NodeError(f'{", ".join(sorted(lost))} left in mid-session, or cannot be reached any more')

    def readers(self, topic: str) -> list[str]:
        """Return the names of the nodes that read a topic."""
        return node_names(self._node.get_subscriptions_info_by_topic(topic))

    def _missing(self) -> set[str]:
        missing = self._unwritten()
        for topic, wanted in self._writes.items():
            missing |= wanted - set(self.readers(topic.name))
        return missing

    def _unwritten(self, over: Collection[str] = ()) -> set[str]:
        """Return who would write the topics that this node reads and nobody writes."""
        return {
            writer_of(topic).name for topic in self._reads if topic.name not in over and not self._count_writers(topic)
        }

    def _count_writers(self, topic: Topic[Any]) -> int:
        """Count without asking who they are, which takes seven times as long."""
        return self._node.count_publishers(self._resolved[topic.name])

    def _refuse_doubles(self) -> None:
        for topic in (*self._writes, *self._reads):
            if self._count_writers(topic) > 1:
                writers = self._node.get_publishers_info_by_topic(topic.name)
                domain = self._node.context.get_domain_id()
                names = ', '.join(node_names(writers))
                raise NodeError(
                    f'{len(writers)} nodes write {topic.name} in domain {domain}: a rig is there already ({names}); '
                    'choose another ROS_DOMAIN_ID or stop it'
                )
