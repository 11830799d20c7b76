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


REPEAT_PERIOD = 1.0
"""Seconds of wall time between two publications of a time that stands still."""


class ClockPublisher:
    """Publishes `/clock` for a node that owns time."""

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(Clock, '/clock', VIEW)
        self._throttle = Throttle()
        self._repeats = Throttle(REPEAT_PERIOD)
        self._stamp_ns: int | None = None

    def publish(self, stamp_ns: int, *, is_last: bool) -> None:
        """Publish a simulated time, unless the last is too fresh; always the last before time stands still."""
        if self._throttle.due() or is_last:
            self._publish(stamp_ns)

    def repeat(self, first_ns: int) -> None:
        """Publish the time again, or the first if there was none, for who joined since time stands still."""
        if self._repeats.due():
            self._publish(first_ns if self._stamp_ns is None else self._stamp_ns)

    def _publish(self, stamp_ns: int) -> None:
        self._stamp_ns = stamp_ns
        self._publisher.publish(Clock(clock=to_time(stamp_ns)))


def to_time(nanoseconds: int) -> Time:
    """Return a ROS time."""
    return Time(sec=nanoseconds // SECOND, nanosec=nanoseconds % SECOND)
