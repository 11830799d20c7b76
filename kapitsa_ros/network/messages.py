"""Between the messages of the network and the plain types of the other rooms.

Messages are written through the typestore of rosbags, not through rclpy: rclpy leaves the padding between fields
unset, and equal runs must give equal bytes.
"""

from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING, Any

import numpy as np
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore

from kapitsa_ros.instruments.stopwatch import StopwatchReading
from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.network import topics
from kapitsa_ros.network.cdr import Block, decode_block, encode_block, encode_silence, is_silence, read_step_id
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.operator.command import Command
from kapitsa_ros.physics.errors import MotionError
from kapitsa_ros.physics.sampled_motion import SampledMotion

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

_STORE = get_typestore(Stores.ROS2_JAZZY)
_SHAFT, _PENDULUM, _PIVOT = 'shaft', 'pendulum', 'pivot'


def load_codecs(kinds: Iterable[str]) -> None:
    """Make what reads and writes messages of these types: rosbags would at their first use, in the middle of a run."""
    for kind in kinds:
        _STORE.get_msgdef(kind)


def _time(nanoseconds: int) -> Any:
    return _STORE.types['builtin_interfaces/msg/Time'](*divmod(nanoseconds, SECOND))


def _header(stamp_ns: int, step_id: StepId) -> Any:
    return _STORE.types['std_msgs/msg/Header'](_time(stamp_ns), str(step_id))


def _encode(kind: str, *values: Any) -> bytes:
    return bytes(_STORE.serialize_cdr(_STORE.types[kind](*values), kind))


def _decode(kind: str, raw: bytes) -> Any:
    try:
        return _STORE.deserialize_cdr(raw, kind)
    except (SerdeError, ValueError, IndexError, struct.error) as error:
        raise WireError(f'not a {kind}: {error}') from error


def encode_command(stamp_ns: int, step_id: StepId, command: Command) -> bytes:
    """Encode what is wanted: the velocity of `shaft`; the position of `pendulum` while it is held."""
    if command.end:
        return encode_silence(topics.COMMAND.type, stamp_ns, StepId(step_id.run, step_id.step, end=True))
    names, position, velocity = [_SHAFT], [0.0], [command.speed]
    if command.hold is not None:
        names, position, velocity = [_SHAFT, _PENDULUM], [0.0, command.hold], [command.speed, 0.0]
    return _encode(
        topics.COMMAND.type, _header(stamp_ns, step_id), names, np.array(position), np.array(velocity), np.array([])
    )


def decode_command(raw: bytes) -> Command:
    """Decode what is wanted.

    Raises
    ------
    WireError
        The message does not name the shaft, its arrays have other sizes, or a number is not finite.

    """
    if read_step_id(raw).end:
        return Command(0.0, None, end=True)
    message = _decode(topics.COMMAND.type, raw)
    if message.name not in ([_SHAFT], [_SHAFT, _PENDULUM]):
        raise WireError(f'a command names shaft, then pendulum where it is held; this one names {message.name}')
    held = len(message.name) == 2
    if len(message.velocity) != len(message.name) or (held and len(message.position) != 2):
        raise WireError('a command has a velocity for each name, and positions where the pendulum is held')
    values = [*message.velocity, *message.position]
    if not np.isfinite(values).all():
        raise WireError('a command is not finite')
    return Command(float(message.velocity[0]), float(message.position[1]) if held else None)


def encode_samples(stamp_ns: int, step_id: StepId, joint: str, samples: SampledMotion) -> bytes:
    """Encode a motion over one step."""
    times = np.arange(samples.position.size) * round(samples.period * SECOND)
    return encode_block(stamp_ns, step_id, Block(joint, times, samples.position, samples.rate, samples.acceleration))


def decode_samples(raw: bytes) -> SampledMotion:
    """Decode a motion over one step.

    Raises
    ------
    WireError
        Times are not equidistant and growing, or the samples are not a motion.

    """
    block = decode_block(raw) or _decode_points(raw)
    periods = np.diff(block.times_ns)
    if not periods.size or block.times_ns[0] != 0 or periods[0] <= 0 or (periods != periods[0]).any():
        raise WireError('a motion block begins at time 0 and its times grow in equal steps')
    try:
        return SampledMotion(float(periods[0]) / SECOND, block.position, block.rate, block.acceleration)
    except MotionError as error:
        raise WireError(str(error)) from error


def _decode_points(raw: bytes) -> Block:
    message = _decode(topics.PIVOT.type, raw)
    if len(message.joint_names) != 1:
        raise WireError(f'a motion block has one joint, this one has {len(message.joint_names)}')
    points = message.points
    columns = [[getattr(point, name) for point in points] for name in ('positions', 'velocities', 'accelerations')]
    if any(len(values) != 1 for column in columns for values in column):
        raise WireError('a motion block has one position, velocity and acceleration a point')
    times = [point.time_from_start.sec * SECOND + point.time_from_start.nanosec for point in points]
    arrays = (np.array(column, float).reshape(-1) for column in columns)
    return Block(message.joint_names[0], np.array(times, np.int64), *arrays)


def encode_strobe(stamp_ns: int, step_id: StepId, reading: StrobeReading | None) -> bytes:
    """Encode what the dial says, stamped with when it was read; or silence."""
    if reading is None:
        return encode_silence(topics.STROBE.type, stamp_ns, step_id)
    header = _header(step_id.run * DAY + round(reading.time * SECOND), step_id)
    empty = np.array([])
    return _encode(topics.STROBE.type, header, [_SHAFT], empty, np.array([reading.speed]), empty)


def decode_strobe(raw: bytes) -> StrobeReading | None:
    """Decode what the dial says."""
    if is_silence(topics.STROBE.type, raw):
        return None
    message = _decode(topics.STROBE.type, raw)
    if not message.name:
        return None
    if message.name != [_SHAFT] or len(message.velocity) != 1 or not np.isfinite(message.velocity).all():
        raise WireError('a strobe reading has one finite velocity, of shaft')
    return StrobeReading(time=_seconds(message.header.stamp, read_step_id(raw)), speed=float(message.velocity[0]))


def encode_stopwatch(stamp_ns: int, step_id: StepId, reading: StopwatchReading | None) -> bytes:
    """Encode what the stopwatch displays, stamped with when it was pressed; or silence."""
    if reading is None:
        return encode_silence(topics.STOPWATCH.type, stamp_ns, step_id)
    header = _header(step_id.run * DAY + round(reading.pressed_at * SECOND), step_id)
    source = f'{reading.kind} {reading.swings} swings'
    return _encode(topics.STOPWATCH.type, header, _time(round(reading.displayed * SECOND)), source)


def decode_stopwatch(raw: bytes) -> StopwatchReading | None:
    """Decode what the stopwatch displays."""
    if is_silence(topics.STOPWATCH.type, raw):
        return None
    message = _decode(topics.STOPWATCH.type, raw)
    match message.source.split(' '):
        case ['']:
            return None
        case ['timed' | 'fell' | 'stopped' as kind, swings, 'swings'] if swings.isdecimal():
            pressed = _seconds(message.header.stamp, read_step_id(raw))
            shown = message.time_ref.sec + message.time_ref.nanosec / SECOND
            return StopwatchReading(pressed_at=pressed, displayed=shown, swings=int(swings), kind=kind)
        case _:
            raise WireError(f'a stopwatch reading has a source like "timed 3 swings", this one has {message.source!r}')


def _seconds(stamp: Any, step_id: StepId) -> float:
    return float((stamp.sec * SECOND + stamp.nanosec - step_id.run * DAY) / SECOND)


def encode_result(stamp_ns: int, step_id: StepId, statuses: Mapping[str, Mapping[str, Any]]) -> bytes:
    """Encode results: one status a name, its values as JSON."""
    status, value = (_STORE.types[f'diagnostic_msgs/msg/{name}'] for name in ('DiagnosticStatus', 'KeyValue'))
    return _encode(
        topics.RESULT.type,
        _header(stamp_ns, step_id),
        [
            status(
                level=0,
                name=name,
                message='',
                hardware_id='',
                values=[value(key, json.dumps(item)) for key, item in pairs.items()],
            )
            for name, pairs in statuses.items()
        ],
    )


def decode_result(raw: bytes) -> dict[str, dict[str, Any]]:
    """Decode results."""
    message = _decode(topics.RESULT.type, raw)
    try:
        return {status.name: {pair.key: json.loads(pair.value) for pair in status.values} for status in message.status}
    except json.JSONDecodeError as error:
        raise WireError(f'a result is not JSON: {error}') from error


def encode_text(text: str) -> bytes:
    """Encode latched settings."""
    return _encode(topics.SETTINGS_TYPE, text)


def decode_text(raw: bytes) -> str:
    """Decode latched settings."""
    return str(_decode(topics.SETTINGS_TYPE, raw).data)
