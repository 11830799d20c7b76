"""The motion of a joint over one step."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.network.cdr import Block, decode_block, encode_block
from kapitsa_ros.network.codec import Codec
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.network.typestore import deserialise
from kapitsa_ros.physics.errors import MotionError
from kapitsa_ros.physics.sampled_motion import SampledMotion

if TYPE_CHECKING:
    from kapitsa_ros.network.step_id import StepId


class MotionCodec(Codec[SampledMotion]):
    """trajectory_msgs/JointTrajectory of one joint: position, rate and acceleration at each sample, ends included.

    Parameters
    ----------
    joint
        Its name.

    """

    message_type = 'trajectory_msgs/msg/JointTrajectory'
    empty_body = bytes(8)

    def __init__(self, joint: str) -> None:
        self.joint = joint

    def encode(self, stamp_ns: int, step_id: StepId, value: SampledMotion) -> bytes:
        """Encode a motion over one step."""
        times = np.arange(value.position.size) * round(value.period * SECOND)
        block = Block(self.joint, times, value.position, value.rate, value.acceleration)
        return encode_block(stamp_ns, step_id, block)

    def decode(self, raw: bytes) -> SampledMotion:
        """Decode a motion over one step.

        Raises
        ------
        WireError
            Times are not equidistant and growing, or the samples are not a motion.

        """
        block = decode_block(raw) or self._decode_points(raw)
        period = _period(block.times_ns.tobytes())
        try:
            return SampledMotion(period, block.position, block.rate, block.acceleration)
        except MotionError as error:
            raise WireError(str(error)) from error

    def _decode_points(self, raw: bytes) -> Block:
        """Read a block that its writer has laid out otherwise than `encode_block` does."""
        message = deserialise(self.message_type, raw)
        if len(message.joint_names) != 1:
            raise WireError(f'a motion block has one joint, this one has {len(message.joint_names)}')
        points = message.points
        columns = [[getattr(point, name) for point in points] for name in ('positions', 'velocities', 'accelerations')]
        if any(len(values) != 1 for column in columns for values in column):
            raise WireError('a motion block has one position, velocity and acceleration a point')
        times = [point.time_from_start.sec * SECOND + point.time_from_start.nanosec for point in points]
        arrays = (np.array(column, float).reshape(-1) for column in columns)
        return Block(message.joint_names[0], np.array(times, np.int64), *arrays)


@lru_cache(maxsize=8)
def _period(times_ns: bytes) -> float:
    """Return the seconds from one time to the next."""
    times = np.frombuffer(times_ns, np.int64)
    periods = np.diff(times)
    if not periods.size or times[0] != 0 or periods[0] <= 0 or (periods != periods[0]).any():
        raise WireError('a motion block begins at time 0 and its times grow in equal steps')
    return float(periods[0]) / SECOND
