"""Who else has to be there before the first step."""

from __future__ import annotations

import shutil
import time
from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.registry import readers_of, writer_of, writers_of
from kapitsa_ros.ros.errors import NodeError
from kapitsa_ros.ros.node_names import NAMELESS, UNKNOWN, node_names, wait_for_names
from kapitsa_ros.ros.writer_watch import heard_writers

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from rclpy.node import Node

    from kapitsa_ros.network.topic import Topic

DISCOVERY = 3.0
"""Seconds for which DDS announces a node often (see config/loopback.xml): then all who are there know of it."""
_PREFIX = 12
"""Bytes of the id of an end that are its participant's (RTPS specification, 9.3.1)."""
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
        self._resolved = {topic: node.resolve_topic_name(topic.name) for topic in (*self._writes, *self._reads)}
        """Names on the graph: they may be remapped."""
        self._expected = expected
        self._joined = time.monotonic()
        self._is_by_itself = False
        """Whether all peers are of this process, which needs no DDS to find them."""
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
            self._is_by_itself = len(self._participants()) == 1
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

    def refuse_lost(self, lost: Collection[str], *, heard: bool) -> None:
        """Look whether everyone whom this node reads still is there; called now and then.

        Who only reads may leave: it was through before this node, and where it was not, those it writes to miss it.

        Parameters
        ----------
        lost
            Roles whose writers are not there, and have not said that no run follows.
        heard
            Whether a message came since the last call: then what a lost one said last may still be on its way.

        Raises
        ------
        NodeError
            Someone has been out of reach for too long.

        """
        now = time.monotonic()
        if not lost or heard:
            self._lost_since = None
        elif self._lost_since is None:
            self._lost_since = now
        elif now - self._lost_since > LOST:
            raise NodeError(f'{", ".join(sorted(lost))} left in mid-session, or cannot be reached any more')

    def give_way(self) -> bool:
        """Refuse another rig that is found only now; return False if it has to be looked again.

        Nodes of one process find one another before DDS has found anybody else; between processes it finds all alike.
        Who has been in the domain for longer than that takes was there first, and goes on.

        Raises
        ------
        NodeError
            Someone else has this node's role, or that of one whom it reads.

        """
        if not self._is_by_itself or time.monotonic() - self._joined > DISCOVERY:
            return True
        clear = True
        for topic in self._resolved:
            writers = heard_writers(self._node, topic)
            names = {end.node_name for end in writers}
            if sum(end.node_name in writers_of(topic) for end in writers) > 1:
                raise self._double(topic, len(writers))
            clear = clear and UNKNOWN not in names
        return clear

    def readers(self, topic: str) -> list[str]:
        """Return the names of the nodes that read a topic."""
        return node_names(self._node.get_subscriptions_info_by_topic(topic))

    def _missing(self) -> set[str]:
        missing = self._unwritten()
        for topic, wanted in self._writes.items():
            missing |= wanted - set(self.readers(topic.name))
        return missing

    def _participants(self) -> set[bytes]:
        """Return the ids of the participants of DDS, one a process, that have the peers of this node."""
        ends = [end for topic in self._resolved for end in self._node.get_publishers_info_by_topic(topic.name)]
        ends += [end for topic in self._writes for end in self._node.get_subscriptions_info_by_topic(topic.name)]
        return {bytes(end.endpoint_gid[:_PREFIX]) for end in ends if end.node_name in self._expected}

    def _unwritten(self) -> set[str]:
        """Return who would write the topics that this node reads, and is not there."""
        return {writer_of(topic).name for topic in self._reads if not self._is_written(topic)}

    def _is_written(self, topic: Topic[Any]) -> bool:
        if not self._count_writers(topic):
            return False
        return any(end.node_name in writers_of(topic) for end in heard_writers(self._node, topic))

    def _count_writers(self, topic: Topic[Any]) -> int:
        """Count without asking who they are, which takes seven times as long."""
        return self._node.count_publishers(self._resolved[topic])

    def _refuse_doubles(self) -> None:
        for topic in self._resolved:
            if self._count_writers(topic) > 1 and len(writers := heard_writers(self._node, topic)) > 1:
                raise self._double(topic, len(writers))

    def _double(self, topic: Topic[Any], count: int) -> NodeError:
        domain = self._node.context.get_domain_id()
        names = wait_for_names(lambda: node_names(heard_writers(self._node, topic)))
        strangers = [name for name in names if name not in writers_of(topic) and name != NAMELESS]
        why = f'{", ".join(strangers)} is not of the rig' if strangers else 'a rig is there already'
        return NodeError(
            f'{count} nodes write {topic.name} in domain {domain}: {why} ({", ".join(names)}); '
            'choose another ROS_DOMAIN_ID or stop it'
        )
