"""Requests of a person on `operator/speed` and `operator/release`: all that clients of the view may publish."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any

from std_msgs.msg import Float64

from kapitsa_ros.live_view.names import is_full_name
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import REQUESTS
from kapitsa_ros.network.typestore import deserialise
from kapitsa_ros.ros.throttle import Throttle

if TYPE_CHECKING:
    from foxglove.websocket import Client, ClientChannel
    from rclpy.node import Node
    from rclpy.publisher import Publisher

    from kapitsa_ros.live_view.foxglove_server import FoxgloveServer

_TYPE = 'std_msgs/msg/Float64'
_PERIOD = 0.02
"""Seconds between two requests on a topic: of those that come between, the newest counts."""
_PATIENCE = 3.0
"""Seconds for which an operator is looked for."""


class RequestForwarder:
    """Publishes what clients ask of an operator who is there for it, and refuses all else that they publish.

    Parameters
    ----------
    node
        Who publishes.
    server
        Whose clients are told what is refused.

    """

    def __init__(self, node: Node, server: FoxgloveServer) -> None:
        self._node, self._server = node, server
        self._channels: dict[tuple[int, int], str] = {}
        """Topics by client and its own number of the channel."""
        self._asked: dict[str, tuple[float, float]] = {}
        """What is to be published by topic, and since when."""
        self._lock = threading.Lock()
        self._publishers: dict[str, tuple[Publisher, Throttle]] = {}

    def advertise(self, client: Client, channel: ClientChannel) -> None:
        """Take note of a topic on which a client wants to publish, or say why nothing there will be used."""
        if '/'.join(channel.topic.rsplit('/', 2)[1:]) not in REQUESTS or not is_full_name(channel.topic):
            self._server.warn(f'{channel.topic} is not open to clients: publish on {" or ".join(REQUESTS)}')
        elif channel.schema_name not in {_TYPE, 'std_msgs/Float64'}:
            self._server.warn(f'{channel.topic} takes {_TYPE}, not {channel.schema_name}')
        else:
            self._channels[client.id, channel.id] = channel.topic

    def unadvertise(self, client: Client, channel_id: int) -> None:
        """Forget a topic of a client."""
        self._channels.pop((client.id, channel_id), None)

    def take(self, client: Client, channel_id: int, data: bytes) -> bool:
        """Take a message of a client in; return whether there is something to publish."""
        topic = self._channels.get((client.id, channel_id))
        if topic is None:
            return False
        try:
            message: Any = deserialise(_TYPE, data)
        except WireError as error:
            self._server.warn(f'{topic}: {error}')
            return False
        with self._lock:
            since = self._asked[topic][1] if topic in self._asked else time.monotonic()
            self._asked[topic] = message.data, since
        return True

    def publish(self) -> float:
        """Publish what is due and would be heard; return the seconds until the next call."""
        with self._lock:
            asked = dict(self._asked)
        for topic, request in asked.items():
            value, since = request
            publisher, throttle = self._publisher(topic)
            if publisher.get_subscription_count():
                if not throttle.due():
                    continue
                publisher.publish(Float64(data=value))
            elif time.monotonic() - since < _PATIENCE:
                continue
            else:
                self._server.warn(f'nobody takes {topic}: an operator does with protocol:=manual')
            with self._lock:
                if self._asked[topic] is request:
                    del self._asked[topic]
        return _PERIOD if self._asked else float('inf')

    def _publisher(self, topic: str) -> tuple[Publisher, Throttle]:
        if topic not in self._publishers:
            self._publishers[topic] = self._node.create_publisher(Float64, topic, 10), Throttle(_PERIOD)
        return self._publishers[topic]
