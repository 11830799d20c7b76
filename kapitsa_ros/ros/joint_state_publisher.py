"""The topic `joint_states`."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from sensor_msgs.msg import JointState
from std_msgs.msg import Header

from kapitsa_ros.ros.clock_publisher import to_time
from kapitsa_ros.ros.frame_schedule import FrameSchedule
from kapitsa_ros.ros.qos import VIEW

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from kapitsa_ros.physics.sampled_motion import SampledMotion

JOINTS = ['pivot', 'pendulum']
"""As the URDF names them."""


class JointStatePublisher:
    """Publishes the motion for viewers, and neither waits for them nor lets them wait."""

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(JointState, 'joint_states', VIEW)
        self._schedule = FrameSchedule()

    def offer(
        self, stamp_ns: int, blocks: Callable[[], tuple[SampledMotion, SampledMotion]], *, is_last: bool = False
    ) -> None:
        """Take the motion of pivot and pendulum over a step, if a viewer could use it by now.

        The last before time stands still is always taken: it is what viewers will see until time goes on.
        """
        now = time.monotonic()
        if is_last or self._schedule.wants(now):
            self._schedule.take(now, stamp_ns, *blocks())

    def refresh(self) -> float:
        """Publish what is due; return the seconds until the next call."""
        now = time.monotonic()
        frame = self._schedule.due(now)
        if frame is not None:
            self._publisher.publish(
                JointState(
                    header=Header(stamp=to_time(frame.stamp_ns)),
                    name=JOINTS,
                    position=frame.position,
                    velocity=frame.velocity,
                )
            )
        return self._schedule.wait(now)

    def wait(self) -> float:
        """Return the seconds until the next frame is due."""
        return self._schedule.wait(time.monotonic())
