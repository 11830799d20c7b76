"""Acknowledgements: the number of a step says all."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.codec import Codec

if TYPE_CHECKING:
    from kapitsa_ros.network.step_id import StepId


class AcknowledgementCodec(Codec[None]):
    """std_msgs/Header."""

    message_type = 'std_msgs/msg/Header'
    empty_body = b''

    def encode(self, stamp_ns: int, step_id: StepId, value: None = None) -> bytes:  # noqa: ARG002
        """Encode the number of a step."""
        return self.encode_silence(stamp_ns, step_id)

    def decode(self, raw: bytes) -> None:
        """Check that there is a number."""
        read_step_id(raw)
