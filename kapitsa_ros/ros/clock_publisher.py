"""The topic `/clock`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from builtin_interfaces.msg import Time
from rosgraph_msgs.msg import Clock

from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.ros.qos import VIEW
from kapitsa_ros.ros.throttle import Throttle

if TYPE_CHECKING:
    from rclpy.node import Node


class ClockPublisher:
    """Publishes `/clock` for a node that owns time."""

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(Clock, '/clock', VIEW)
        self._throttle = Throttle()

    def publish(self, stamp_ns: int, *, is_last: bool) -> None:
        """Publish a simulated time, unless the last is too fresh; always the last before time stands still."""
        if self._throttle.due() or is_last:
            self._publisher.publish(Clock(clock=to_time(stamp_ns)))


def to_time(nanoseconds: int) -> Time:
    """Return a ROS time."""
    return Time(sec=nanoseconds // SECOND, nanosec=nanoseconds % SECOND)
