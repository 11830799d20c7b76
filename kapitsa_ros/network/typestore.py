"""Messages written and read through the typestore of rosbags.

Not through rclpy: it leaves the padding between fields unset, and equal runs must give equal bytes.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore

from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.units import counted

if TYPE_CHECKING:
    from kapitsa_ros.network.step_id import StepId

_STORE = get_typestore(Stores.ROS2_JAZZY)


def load_type(message_type: str) -> None:
    """Generate what reads and writes a message type: rosbags would at its first use, in the middle of a run."""
    _STORE.get_msgdef(message_type)


def knows(message_type: str) -> bool:
    """Whether messages of a type can be read here."""
    return message_type in _STORE.types


def definition_of(message_type: str) -> str:
    """Return the definition of a message type with those it consists of, as bags hold it (encoding `ros2msg`)."""
    return str(_STORE.generate_msgdef(message_type)[0])


def begins_with_header(message_type: str) -> bool:
    """Whether messages of a type begin with a std_msgs/Header, and so with a stamp."""
    fields = _STORE.fielddefs[message_type][1]
    return bool(fields) and fields[0][1][1] == 'std_msgs/msg/Header'


def new_message(message_type: str, *values: Any, **fields: Any) -> Any:
    """Return a message of a type such as `std_msgs/msg/Header`."""
    return _STORE.types[message_type](*values, **fields)


def new_time(nanoseconds: int) -> Any:
    """Return a builtin_interfaces/Time."""
    return new_message('builtin_interfaces/msg/Time', *divmod(nanoseconds, SECOND))


def new_header(stamp_ns: int, step_id: StepId) -> Any:
    """Return the header of a numbered message."""
    return new_message('std_msgs/msg/Header', new_time(stamp_ns), str(step_id))


def serialise(message_type: str, *values: Any) -> bytes:
    """Return the CDR bytes of a message with these fields."""
    return bytes(_STORE.serialize_cdr(new_message(message_type, *values), message_type))


def deserialise(message_type: str, raw: bytes) -> Any:
    """Return the message in CDR bytes.

    Raises
    ------
    WireError
        The bytes are no such message.

    """
    try:
        return _STORE.deserialize_cdr(raw, message_type)
    except (SerdeError, ValueError, IndexError, struct.error) as error:
        raise WireError(f'not a {message_type}: its {counted(len(raw), "byte")} are laid out otherwise') from error


def seconds_at(stamp: Any, step_id: StepId) -> float:
    """Return the seconds from the start of a run to a builtin_interfaces/Time."""
    return float((stamp.sec * SECOND + stamp.nanosec - step_id.run * DAY) / SECOND)
