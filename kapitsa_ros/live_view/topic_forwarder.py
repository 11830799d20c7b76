"""The topics of the graph, as channels: each is subscribed to while a client wants it, and handed on byte by byte."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from rclpy._rclpy_pybind11 import RCLError  # it has no public type
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from kapitsa_ros.live_view.names import is_full_name
from kapitsa_ros.network.typestore import begins_with_header, definition_of, knows
from kapitsa_ros.ros.qos import message_class
from kapitsa_ros.ros.rclpy_errors import first_line

if TYPE_CHECKING:
    from collections.abc import Collection

    from rclpy.subscription import Subscription

    from kapitsa_ros.live_view.foxglove_server import FoxgloveServer
    from kapitsa_ros.live_view.view_clock import ViewClock
    from kapitsa_ros.ros.process_node import ProcessNode

_DEPTH = 100
_STREAM = QoSProfile(depth=_DEPTH, history=HistoryPolicy.KEEP_LAST, reliability=ReliabilityPolicy.BEST_EFFORT)
"""Whoever looks holds nobody up."""
_LATCHED = QoSProfile(
    depth=_DEPTH,
    history=HistoryPolicy.KEEP_LAST,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)


class TopicForwarder:
    """All topics that somebody publishes, of message types that are known here.

    Parameters
    ----------
    node
        Who subscribes.
    server
        Where the channels are.
    clock
        Tells when a message is shown.

    """

    def __init__(self, node: ProcessNode, server: FoxgloveServer, clock: ViewClock) -> None:
        self._node, self._server, self._clock = node, server, clock
        self._topics: dict[str, _ForwardedTopic] = {}
        self._newcomers: deque[tuple[int, str]] = deque()
        self._unknown: set[str] = set()

    def look(self, own: Collection[str]) -> None:
        """Look for new topics; `own` are those that the view itself makes."""
        for name, types in self._node.get_topic_names_and_types():
            if name in self._topics or name in own or not is_full_name(name) or not self._node.count_publishers(name):
                continue
            if self._is_known(name, types[0]):
                self._topics[name] = _ForwardedTopic(self._node, self._server, self._clock, name, types[0])

    def note(self, client: int, topic: str) -> None:
        """Take note that a client has subscribed; called in a thread of the server."""
        self._newcomers.append((client, topic))

    def tend(self) -> None:
        """Subscribe to what clients want, and to nothing else; tell those who have come later what is latched."""
        while self._newcomers:
            client, name = self._newcomers.popleft()
            if name in self._topics:
                self._topics[name].repeat(client)
        for name, topic in self._topics.items():
            try:
                topic.tend()
            except RCLError as error:  # somebody publishes another type there
                self._node.refuse(f'{name}: {first_line(error)}')

    def repeat(self) -> None:
        """Tell all clients what is latched: only now is it known at what time."""
        for topic in self._topics.values():
            topic.repeat()

    def _is_known(self, topic: str, message_type: str) -> bool:
        if message_type in self._unknown:
            return False
        try:
            message_class(message_type)
        except (ImportError, AttributeError, ValueError):
            is_known = False
        else:
            is_known = knows(message_type)
        if not is_known:
            self._unknown.add(message_type)
            self._node.get_logger().warning(f'{topic} is not shown: {message_type} is unknown here')
        return is_known


class _ForwardedTopic:
    def __init__(
        self, node: ProcessNode, server: FoxgloveServer, clock: ViewClock, name: str, message_type: str
    ) -> None:
        self._node, self._clock, self._name, self._type = node, clock, name, message_type
        self._channel = server.channel(name, message_type, definition_of(message_type))
        self._has_header = begins_with_header(message_type)
        self._subscription: Subscription | None = None
        self._is_latched = False
        self._latched: bytes | None = None
        """The newest message."""

    def tend(self) -> None:
        is_wanted = self._channel.has_sinks()
        if is_wanted and self._subscription is None:
            ends = self._node.get_publishers_info_by_topic(self._name)
            self._is_latched = any(end.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for end in ends)
            self._subscription = self._node.create_subscription(
                message_class(self._type), self._name, self._take, _LATCHED if self._is_latched else _STREAM, raw=True
            )
        elif self._subscription is not None and not is_wanted:
            self._node.destroy_subscription(self._subscription)
            self._subscription = self._latched = None

    def repeat(self, client: int | None = None) -> None:
        if self._latched is not None:
            self._show(self._latched, client)

    def _take(self, raw: bytes) -> None:
        self._show(raw)
        if self._is_latched:
            self._latched = raw

    def _show(self, raw: bytes, client: int | None = None) -> None:
        time_ns = self._clock.time_of(raw, has_header=self._has_header)
        if time_ns is not None:
            self._channel.log(raw, log_time=time_ns, sink_id=client)
