"""Which writer of a topic is its own, and whether it still is there: by the ids that DDS gives to writers."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from rclpy.qos import ReliabilityPolicy

from kapitsa_ros.network.registry import writers_of
from kapitsa_ros.ros.node_names import NAMELESS, UNKNOWN, node_names, wait_for_names

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.topic_endpoint_info import TopicEndpointInfo

    from kapitsa_ros.network.topic import Topic

LAG = 1.0
"""Seconds after which the graph shows what a match event told of: it does so a moment later."""


def heard_writers(node: Node, topic: Topic[Any]) -> list[TopicEndpointInfo]:
    """Return the writers whose messages a reader of a numbered topic hears; others only bear the topic's name."""
    return [
        end
        for end in node.get_publishers_info_by_topic(topic.name)
        if end.topic_type == topic.type and end.qos_profile.reliability == ReliabilityPolicy.RELIABLE
    ]


class WriterWatch:
    """Watches who writes a numbered topic, as one subscription hears them.

    Who wrote a message, it does not say. But the graph shows the ids of all writers: where one was alone when the
    first message came, it is the topic's own, and no other is for as long as the session lasts. The graph is asked
    when a match event says that it has changed, or a number that it may have; not with each message.
    """

    def __init__(self, node: Node, topic: Topic[Any]) -> None:
        self._node, self._topic = node, topic
        self._roles = writers_of(topic)
        self._heard: dict[bytes, str] = {}
        """Names of the nodes of all writers that are heard, by id."""
        self._matched = 0
        self._own: bytes | None = None
        self._newcomers = False
        """Whether somebody may have been there since the topic's own writer was last known to be.

        That may have been itself, late on the graph: only the count of all matches tells.
        """
        self._is_shown = True
        """Whether the graph shows what the last match event told of."""
        self._lagging_until = 0.0
        self.has_been_alone = True
        """Whether no more than one writer was ever matched."""
        self.is_steady = False
        """Whether the topic's own writer is known and there, and the graph shows all who are heard: nothing to ask."""

    def is_alone(self) -> bool:
        """Look whether no more than one writer is there: a message may come before the match event of its writer."""
        self._look()
        return self._matched <= 1 and len(self._heard) <= 1

    @property
    def is_known(self) -> bool:
        """Whether it is known which writer is the topic's own."""
        return self._own is not None

    @property
    def is_gone(self) -> bool:
        """Whether the topic's own writer is not there; before it is known, whether nobody is there who could be it."""
        if self._own is None:
            return not any(map(self._may_be_own, self._heard.values()))
        return self._own not in self._heard

    def note_match(self, event: Any) -> None:
        """Note that writers have come or left."""
        self._matched = event.current_count
        self._newcomers = self._newcomers or event.total_count_change > 0
        self.has_been_alone = event.total_count <= 1
        self._lagging_until = time.monotonic() + LAG
        self._look()

    def refresh(self) -> None:
        """Look again where the graph did not show yet what a match event told of."""
        if not self._is_shown:
            self._look()

    def know(self, *, counts_from_the_first: bool) -> bool:
        """Take the one writer that is heard for the topic's own, if its name says so; return False if it does not.

        Where several are heard none can be taken for it, and it stays unknown.

        Parameters
        ----------
        counts_from_the_first
            Whether what came fits a writer that has just begun: one whose name is not known has to.

        """
        self._look()
        names = self._roles | ({UNKNOWN} if counts_from_the_first else set())
        candidates = [gid for gid, name in self._heard.items() if name in names]
        if len(self._heard) == 1 and self._matched <= 1 and candidates:
            [self._own] = candidates
            self._newcomers = False
            self._look()
        return bool(candidates)

    def fault(self) -> str | None:
        """Return why what comes now may be somebody else's, or what came before was; None: there is no sign of that."""
        if self._own is None:
            return None
        if self._own in self._heard:
            name = self._heard[self._own]
            return None if self._may_be_own(name) else f'was written by {name}, whose topic it is not'
        if not self._newcomers or self.has_been_alone:  # what has been said before may still be on its way
            return None
        others = ', '.join(wait_for_names(self.strangers)) or 'a node that has left'
        return f'has lost its writer in mid-session, and has another: {others}'

    def strangers(self) -> list[str]:
        """Return the names of nodes that write besides the one whose topic it is, whatever their messages are."""
        ends = self._node.get_publishers_info_by_topic(self._topic.name)
        names = node_names(end for end in ends if bytes(end.endpoint_gid) != self._own)
        if self._own is None:
            own = next((name for name in names if name in self._roles), NAMELESS)
            if own in names:  # of those without a name one may be the topic's own
                names.remove(own)
        return [f'another {name}' if name in self._roles else name for name in names]

    def _look(self) -> None:
        known, self._heard = self._heard, {}
        for end in heard_writers(self._node, self._topic):
            gid, name = bytes(end.endpoint_gid), end.node_name
            self._heard[gid] = known.get(gid, name) if name == UNKNOWN else name  # who leaves loses its name first
        name = self._heard.get(self._own) if self._own is not None else None
        self._is_shown = len(self._heard) == self._matched and name != UNKNOWN
        if name is None:
            self._newcomers = self._newcomers or (self._own is not None and bool(self._heard))
        elif self._is_shown:
            self._newcomers = False
        lags = not self._is_shown and time.monotonic() < self._lagging_until
        self.is_steady = name is not None and self._may_be_own(name) and not lags

    def _may_be_own(self, name: str) -> bool:
        return name in self._roles or name == UNKNOWN
