"""A numbered topic: one message a step, from one writer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from kapitsa_ros.network.codec import Codec
    from kapitsa_ros.network.step_id import StepId

T = TypeVar('T')


@dataclass(frozen=True, eq=False)
class Topic(Generic[T]):
    """A numbered topic and how its values travel; who writes and reads it, the roles say."""

    name: str
    codec: Codec[T]
    recorded: bool = True
    """Whether a bag holds it."""
    replayed: bool = True
    """Whether the player puts it back; what is not replayed is made anew."""
    reading: bool = False
    """Whether it says now and then what an instrument reads: those make a run."""

    @property
    def type(self) -> str:
        """Message type, such as `std_msgs/msg/Header`."""
        return self.codec.message_type

    def encode(self, stamp_ns: int, step_id: StepId, value: T) -> bytes:
        """Return the message of a step."""
        return self.codec.encode(stamp_ns, step_id, value)

    def decode(self, raw: bytes) -> T:
        """Return what a message says.

        Raises
        ------
        WireError
            The bytes are no message of this topic.

        """
        return self.codec.decode(raw)
