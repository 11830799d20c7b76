"""How the values of a topic travel as messages."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar, Generic, TypeVar

from kapitsa_ros.network.cdr import aligned, encode_header, header_size, read_step_id

if TYPE_CHECKING:
    from kapitsa_ros.network.step_id import StepId

T = TypeVar('T')


class Codec(ABC, Generic[T]):
    """Between a plain type and the bytes of one message type that begins with a header.

    Messages are little-endian CDR, and equal values give equal bytes.
    """

    message_type: ClassVar[str]
    """Such as `std_msgs/msg/Header`."""
    empty_body: ClassVar[bytes]
    """What follows the header of a silent message: all sequences and strings empty, all numbers 0."""

    @abstractmethod
    def encode(self, stamp_ns: int, step_id: StepId, value: T) -> bytes:
        """Return the message of a step.

        Parameters
        ----------
        stamp_ns
            Simulated time at which the step begins, ns.
        step_id
            Its number.
        value
            What the message says.

        """

    @abstractmethod
    def decode(self, raw: bytes) -> T:
        """Return what a message says.

        Raises
        ------
        WireError
            The bytes are no message of this topic.

        """

    def encode_silence(self, stamp_ns: int, step_id: StepId) -> bytes:
        """Return a message that holds nothing but its number."""
        head = encode_header(stamp_ns, step_id)
        return head + bytes(aligned(len(head), 4) if self.empty_body else 0) + self.empty_body

    def is_silence(self, raw: bytes) -> bool:
        """Whether a message holds nothing but its number.

        Raises
        ------
        WireError
            It does not even hold that.

        """
        read_step_id(raw)
        head = header_size(raw)
        size = head + aligned(head, 4) + len(self.empty_body)
        return len(raw) <= size + aligned(size, 4)  # on its way a message is padded to whole words
