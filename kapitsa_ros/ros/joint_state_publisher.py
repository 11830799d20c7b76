"""The topic `joint_states`."""

from __future__ import annotations

import math
import time
from contextlib import suppress
from typing import TYPE_CHECKING

from sensor_msgs.msg import JointState
from std_msgs.msg import Header

from kapitsa_ros.network.errors import WireError
from kapitsa_ros.ros.clock_publisher import to_time
from kapitsa_ros.ros.frame_schedule import FrameSchedule, frame_of
from kapitsa_ros.ros.qos import VIEW

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from kapitsa_ros.physics.sampled_motion import SampledMotion
    from kapitsa_ros.ros.frame import Frame

    _Block = tuple[int, Callable[[], tuple[SampledMotion, SampledMotion]]]

JOINTS = ['pivot', 'pendulum']
"""As the URDF names them."""
REPEAT_PERIOD = 1.0
"""Seconds of wall time after which the last state is shown again where no step comes: to who joined meanwhile."""


class JointStatePublisher:
    """Publishes the motion for viewers, and neither waits for them nor lets them wait."""

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(JointState, 'joint_states', VIEW)
        self._schedule = FrameSchedule()
        self._newest: _Block | None = None
        """A step that came too soon after the one before: should time stand still now, viewers have to see it."""
        self._latest: _Block | None = None
        self._last_at = 0.0
        """When the latest step came, or its end was shown last."""

    def offer(self, stamp_ns: int, blocks: Callable[[], tuple[SampledMotion, SampledMotion]]) -> None:
        """Take the motion of pivot and pendulum over a step, once a viewer can use it, unless a newer one has come."""
        self._newest = self._latest = stamp_ns, blocks
        self._last_at = time.monotonic()
        self._take(self._last_at)

    def refresh(self) -> float:
        """Publish what is due; return the seconds until the next call."""
        now = time.monotonic()
        self._take(now)
        frame = self._schedule.due(now) or self._again(now)
        if frame is not None:
            self._publisher.publish(
                JointState(
                    header=Header(stamp=to_time(frame.stamp_ns)),
                    name=JOINTS,
                    position=frame.position,
                    velocity=frame.velocity,
                )
            )
        return self._wait(now)

    def wait(self) -> float:
        """Return the seconds until the next frame is due."""
        return self._wait(time.monotonic())

    def _take(self, now: float) -> None:
        if self._newest is not None and self._schedule.wants(now):
            stamp_ns, blocks = self._newest
            self._newest = None
            if not self._publisher.get_subscription_count():  # fifty frames a second would be half of the wake-ups
                self._schedule.skip(now)
                return
            with suppress(WireError):  # of a bag, which may still be analysed
                self._schedule.take(now, stamp_ns, *blocks())

    def _again(self, now: float) -> Frame | None:
        """Return the end of the latest step once in a while, as long as no other comes."""
        is_waited_for = self._newest is not None or math.isfinite(self._schedule.wait(now))
        if self._latest is None or is_waited_for or now - self._last_at < REPEAT_PERIOD:
            return None
        self._last_at = now
        if self._publisher.get_subscription_count():
            stamp_ns, blocks = self._latest
            with suppress(WireError):
                pivot, motion = blocks()
                return frame_of(motion.position.size - 1, now, stamp_ns, pivot, motion)
        return None

    def _wait(self, now: float) -> float:
        wait = self._schedule.wait(now)
        return wait if self._newest is None else min(wait, self._schedule.wait_for_block(now))
