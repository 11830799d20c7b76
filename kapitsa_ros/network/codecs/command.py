"""Commands of the operator."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.network.cdr import body_of, read_step_id, with_empty_header
from kapitsa_ros.network.codec import Codec
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.network.typestore import deserialise, new_header, serialise
from kapitsa_ros.operator.command import Command

if TYPE_CHECKING:
    from typing import Any

_SHAFT, _PENDULUM = 'shaft', 'pendulum'


class CommandCodec(Codec[Command]):
    """sensor_msgs/JointState: `velocity` of `shaft`; `position` of `pendulum` while it is held."""

    message_type = 'sensor_msgs/msg/JointState'
    empty_body = bytes(16)

    def encode(self, stamp_ns: int, step_id: StepId, value: Command) -> bytes:
        """Encode a command; the end of a run is silence."""
        if value.end:
            return self.encode_silence(stamp_ns, StepId(step_id.run, step_id.step, end=True))
        names, position, velocity = [_SHAFT], [0.0], [value.speed]
        if value.hold is not None:
            names, position, velocity = [_SHAFT, _PENDULUM], [0.0, value.hold], [value.speed, 0.0]
        arrays = (np.array(position), np.array(velocity), np.array([]))
        return serialise(self.message_type, new_header(stamp_ns, step_id), names, *arrays)

    def decode(self, raw: bytes) -> Command:
        """Decode a command.

        Raises
        ------
        WireError
            The message does not name the shaft, its arrays have other sizes, or a number is not finite.

        """
        if read_step_id(raw).end:
            return Command(0.0, None, end=True)
        return _command(*body_of(raw))


@lru_cache(maxsize=64)
def _command(place: int, body: bytes) -> Command:
    """Decode what follows the header: step after step it is the same."""
    message: Any = deserialise(CommandCodec.message_type, with_empty_header(place, body))
    if message.name not in ([_SHAFT], [_SHAFT, _PENDULUM]):
        raise WireError(f'a command names shaft, then pendulum where it is held; this one names {message.name}')
    held = len(message.name) == 2
    if len(message.velocity) != len(message.name) or (held and len(message.position) != 2):
        raise WireError('a command has a velocity for each name, and positions where the pendulum is held')
    values = [*message.velocity, *message.position]
    if not np.isfinite(values).all():
        raise WireError('a command is not finite')
    return Command(float(message.velocity[0]), float(message.position[1]) if held else None)
