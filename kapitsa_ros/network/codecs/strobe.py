"""Readings of the strobe."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.codec import Codec
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.network.typestore import deserialise, new_header, seconds_at, serialise

if TYPE_CHECKING:
    from kapitsa_ros.network.step_id import StepId

_SHAFT = 'shaft'


class StrobeCodec(Codec[StrobeReading | None]):
    """sensor_msgs/JointState: `velocity` of `shaft` as the dial says, stamped with when it was read; or silence."""

    message_type = 'sensor_msgs/msg/JointState'
    empty_body = bytes(16)

    def encode(self, stamp_ns: int, step_id: StepId, value: StrobeReading | None) -> bytes:
        """Encode what the dial says."""
        if value is None:
            return self.encode_silence(stamp_ns, step_id)
        header = new_header(step_id.run * DAY + round(value.time * SECOND), step_id)
        empty = np.array([])
        return serialise(self.message_type, header, [_SHAFT], empty, np.array([value.speed]), empty)

    def decode(self, raw: bytes) -> StrobeReading | None:
        """Decode what the dial says."""
        if self.is_silence(raw):
            return None
        message = deserialise(self.message_type, raw)
        if not message.name:
            return None
        if message.name != [_SHAFT] or len(message.velocity) != 1 or not np.isfinite(message.velocity).all():
            raise WireError('a strobe reading has one finite velocity, of shaft')
        time = seconds_at(message.header.stamp, read_step_id(raw))
        return StrobeReading(time=time, speed=float(message.velocity[0]))
