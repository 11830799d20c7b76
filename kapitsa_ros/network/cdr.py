"""The CDR bytes of numbered messages: their header, and blocks of a motion.

All their types begin with a header, whose `frame_id` holds the number of the step; so the number can be read without
knowing the type. A motion block is encoded from arrays: as Python objects its points cost a hundred times as much.
The layout is little-endian CDR, as rclpy publishes it; the tests compare the two.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.units import counted

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ENCAPSULATION = b'\x00\x01\x00\x00'
_LENGTH = struct.Struct('<I')
_STAMP = struct.Struct('<iI')
NUMBER_LENGTH_AT = len(_ENCAPSULATION) + _STAMP.size
"""Where a message says how long its number is."""
_STEP_ID_AT = NUMBER_LENGTH_AT + _LENGTH.size
_STAMPS = np.dtype([('sec', '<i4'), ('nanosec', '<u4')])
# From the first position of a point to the length before the next point's: every double is aligned to eight bytes, and
# that length closes the gap after time_from_start.
_POINT = np.dtype(
    {
        'names': [
            'position',
            'n_rate',
            'rate',
            'n_acceleration',
            'acceleration',
            'n_effort',
            'sec',
            'nanosec',
            'n_next',
        ],
        'formats': ['<f8', '<u4', '<f8', '<u4', '<f8', '<u4', '<i4', '<u4', '<u4'],
        'offsets': [0, 8, 16, 24, 32, 40, 44, 48, 52],
        'itemsize': 56,
    }
)
_VALUES = range(0, 5, 2)
"""Which eight bytes of a point are position, rate and acceleration."""
POINT_SIZE, RATE_AT = _POINT.itemsize, 8 * _VALUES[1]
"""Bytes from one position to the next, and from a position to its rate."""
_WORDS = POINT_SIZE // 8
_VALUE_COLUMNS = slice(_VALUES.start, _VALUES.stop, _VALUES.step)


class Block(NamedTuple):
    """A motion block as it travels: equal sizes, times in ns from the header's stamp."""

    joint: str
    times_ns: NDArray[np.int64]
    position: NDArray[np.float64]
    rate: NDArray[np.float64]
    acceleration: NDArray[np.float64]


def aligned(size: int, to: int) -> int:
    """Return how many bytes of padding lead from a size to the next multiple of `to`."""
    return -size % to


def _unpack(form: struct.Struct, raw: bytes, at: int) -> tuple[int, ...]:
    try:
        return form.unpack_from(raw, at)
    except struct.error as error:
        raise _too_short(raw) from error


def read_step_id(raw: bytes) -> StepId:
    """Read the number of any message of the network.

    Raises
    ------
    WireError
        The bytes are too short, or `frame_id` holds no number.

    """
    try:
        (length,) = _LENGTH.unpack_from(raw, NUMBER_LENGTH_AT)
        return _step_id(raw[_STEP_ID_AT : _STEP_ID_AT + length - 1])
    except struct.error as error:
        raise _too_short(raw) from error
    except UnicodeDecodeError as error:
        raise WireError('not a numbered message: its number is no text') from error
    except ValueError as error:
        raise WireError(f'not a numbered message: {error}') from error


def _too_short(raw: bytes) -> WireError:
    return WireError(f'not a numbered message: {counted(len(raw), "byte")} without the header of one')


@lru_cache(maxsize=64)
def _step_id(text: bytes) -> StepId:
    """Return the number that a text says; all messages of a step have the same."""
    return StepId.parse(text.decode())


def stamp_of(raw: bytes) -> int:
    """Return the header's stamp, ns.

    Raises
    ------
    WireError
        The bytes are too short.

    """
    seconds, nanoseconds = _unpack(_STAMP, raw, len(_ENCAPSULATION))
    return int(seconds * SECOND + nanoseconds)


def encode_header(stamp_ns: int, step_id: StepId) -> bytes:
    """Encode encapsulation and header."""
    frame = str(step_id).encode() + b'\x00'
    return _ENCAPSULATION + _STAMP.pack(*divmod(stamp_ns, SECOND)) + _LENGTH.pack(len(frame)) + frame


def header_size(raw: bytes) -> int:
    """Return the size of encapsulation and header, bytes.

    Raises
    ------
    WireError
        The bytes are too short.

    """
    (length,) = _unpack(_LENGTH, raw, NUMBER_LENGTH_AT)
    return int(_STEP_ID_AT + length)


def body_of(raw: bytes) -> tuple[int, bytes]:
    """Return what follows the header, and the place in a word of eight bytes at which it begins.

    Raises
    ------
    WireError
        The bytes are too short.

    """
    begin = header_size(raw)
    return begin % 8, raw[begin:]


def with_empty_header(place: int, body: bytes) -> bytes:
    """Return a message with what `body_of` has found, and a header that says nothing."""
    length = 1 + (place - _STEP_ID_AT - 1) % 8
    return _ENCAPSULATION + bytes(_STAMP.size) + _LENGTH.pack(length) + bytes(length) + body


def encode_block(stamp_ns: int, step_id: StepId, block: Block) -> bytes:
    """Encode a motion block as trajectory_msgs/JointTrajectory of one joint."""
    head = encode_header(stamp_ns, step_id)
    joint = block.joint.encode() + b'\x00'
    head += bytes(aligned(len(head), 4)) + _LENGTH.pack(1) + _LENGTH.pack(len(joint)) + joint
    head += bytes(aligned(len(head), 4)) + _LENGTH.pack(len(block.position)) + _LENGTH.pack(1)
    head += bytes(aligned(len(head) - len(_ENCAPSULATION), 8))
    points = bytearray(_points_at_rest(block.times_ns.tobytes()))
    words = np.frombuffer(points, '<f8').reshape(-1, _WORDS)
    for word, values in zip(_VALUES, (block.position, block.rate, block.acceleration), strict=True):
        words[:, word] = values
    return head + bytes(points[: -_LENGTH.size])


@lru_cache(maxsize=8)
def _points_at_rest(times_ns: bytes) -> bytes:
    """Return the points of a block at these times with all values 0: the rest is the same in each."""
    times = np.frombuffer(times_ns, np.int64)
    points = np.zeros(times.size, _POINT)
    points['n_rate'] = points['n_acceleration'] = points['n_next'] = 1
    points['sec'], points['nanosec'] = np.divmod(times, SECOND)
    return points.tobytes()


def decode_block(raw: bytes) -> Block | None:
    """Read a block laid out as `encode_block` does it, or return None: other writers may lay it out otherwise."""
    if (layout := block_layout(raw)) is None:
        return None
    joint, at, count = layout
    words = np.frombuffer(raw + bytes(_LENGTH.size), '<u8', count * _WORDS, at).reshape(count, _WORDS)
    rest = words.copy()
    rest[:, _VALUE_COLUMNS] = 0
    times = _times(rest.tobytes())
    return None if times is None else Block(joint, times, *words[:, _VALUE_COLUMNS].T.copy().view('<f8'))


def _times(rest: bytes) -> NDArray[np.int64] | None:
    """Return the times of a block, ns, from the bytes of its points with all values 0; None where it has others.

    Mostly they are those of the block before. To compare the bytes costs a tenth of what it does to look them up.
    """
    latest = _latest_points(len(rest))
    known, times = latest.points
    if known != rest:
        times = _new_times(rest)
        latest.points = rest, times  # at once, as another thread may read it
    return times


@dataclass(slots=True)
class _Latest:
    points: tuple[bytes, NDArray[np.int64] | None] = (b'', None)
    """With all values 0, and their times."""


@lru_cache(maxsize=8)
def _latest_points(size: int) -> _Latest:  # noqa: ARG001 - the key
    """Return what was read last of so many bytes, for the next to replace."""
    return _Latest()


def _new_times(rest: bytes) -> NDArray[np.int64] | None:
    points = np.frombuffer(rest, _POINT)
    lengths_fit = (
        (points['n_rate'] == 1).all()
        and (points['n_acceleration'] == 1).all()
        and not points['n_effort'].any()
        and (points['n_next'][:-1] == 1).all()
    )
    if not lengths_fit:
        return None
    times: NDArray[np.int64] = points['sec'] * np.int64(SECOND) + points['nanosec']
    times.flags.writeable = False
    return times


def block_layout(raw: bytes) -> tuple[str, int, int] | None:
    """Return joint, place of the points and their number in a block that may be laid out as `encode_block` does it."""
    try:
        (length,) = _LENGTH.unpack_from(raw, NUMBER_LENGTH_AT)
        at = _STEP_ID_AT + length
        at += aligned(at, 4)
        joints, name = struct.unpack_from('<II', raw, at)
        at += 8
        joint = raw[at : at + name - 1].decode()
        at += name
        at += aligned(at, 4)
        count, first = struct.unpack_from('<II', raw, at)
        at += 8
        at += aligned(at - len(_ENCAPSULATION), 8)
    except (struct.error, UnicodeDecodeError):
        return None
    if joints != 1 or first != 1 or not count or len(raw) != at + count * POINT_SIZE - _LENGTH.size:
        return None
    return joint, at, count
