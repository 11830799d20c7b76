"""What viewers see, no more often than they can use."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from builtin_interfaces.msg import Time
from rosgraph_msgs.msg import Clock

from kapitsa_ros.nodes.qos import VIEW
from kapitsa_ros.physics.steps import SECOND

if TYPE_CHECKING:
    from rclpy.node import Node

PERIOD = 0.01
"""Seconds of wall time: a faster clock costs each of its readers a third of a core."""


REPORT_PERIOD = 0.5
"""Seconds of wall time between two reports of progress."""


class Throttle:
    """Lets one through a period of wall time."""

    def __init__(self, period: float = PERIOD) -> None:
        self._period = period
        self._last = -period

    def due(self) -> bool:
        """Whether the period has passed since this last said yes."""
        now = time.monotonic()
        if now - self._last < self._period:
            return False
        self._last = now
        return True


class ClockFace:
    """Publishes `/clock` for a node that owns time."""

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(Clock, '/clock', VIEW)
        self._throttle = Throttle()

    def show(self, stamp_ns: int) -> None:
        """Publish a simulated time, unless the last is too fresh."""
        if self._throttle.due():
            self._publisher.publish(Clock(clock=to_time(stamp_ns)))


def to_time(nanoseconds: int) -> Time:
    """Return a ROS time."""
    return Time(sec=nanoseconds // SECOND, nanosec=nanoseconds % SECOND)
