"""Readings of the stopwatch."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.instruments.stopwatch import StopwatchReading
from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.codec import Codec
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.network.typestore import deserialise, new_header, new_time, seconds_at, serialise

if TYPE_CHECKING:
    from kapitsa_ros.network.step_id import StepId

_DIGITS = 9
"""Of the longest count of swings."""


class StopwatchCodec(Codec[StopwatchReading | None]):
    """sensor_msgs/TimeReference: `time_ref` is the display, `source` its meaning, the stamp when it was pressed."""

    message_type = 'sensor_msgs/msg/TimeReference'
    empty_body = bytes(8) + b'\x01\x00\x00\x00\x00'  # time_ref 0, source ''

    def encode(self, stamp_ns: int, step_id: StepId, value: StopwatchReading | None) -> bytes:
        """Encode what the stopwatch displays."""
        if value is None:
            return self.encode_silence(stamp_ns, step_id)
        header = new_header(step_id.run * DAY + round(value.pressed_at * SECOND), step_id)
        source = f'{value.kind} {value.swings} swings'
        return serialise(self.message_type, header, new_time(round(value.displayed * SECOND)), source)

    def decode(self, raw: bytes) -> StopwatchReading | None:
        """Decode what the stopwatch displays."""
        if self.is_silence(raw):
            return None
        message = deserialise(self.message_type, raw)
        match message.source.split(' '):
            case ['']:
                return None
            case ['timed' | 'fell' | 'stopped' as kind, swings, 'swings'] if (
                swings.isascii() and swings.isdecimal() and len(swings) <= _DIGITS
            ):
                pressed = seconds_at(message.header.stamp, read_step_id(raw))
                displayed = message.time_ref.sec + message.time_ref.nanosec / SECOND
                if kind == 'timed' and int(swings) < 1:
                    raise WireError('a stopwatch reading of 0 swings has no period')
                return StopwatchReading(pressed_at=pressed, displayed=displayed, swings=int(swings), kind=kind)
            case _:
                raise WireError(
                    f'a stopwatch reading has a source like "timed 3 swings", this one has {message.source!r}'
                )
