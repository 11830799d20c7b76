"""The angle of a joint in anybody's bag, from sensor_msgs/JointState."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros.network.cdr import aligned
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import COMMAND, STROBE_READING
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.network.typestore import deserialise
from kapitsa_ros.recording.errors import BagError, printable
from kapitsa_ros.recording.storage.bag_files import BagFiles
from kapitsa_ros.recording.storage.stored_message import StoredTable

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    _Columns = tuple[NDArray[Any], NDArray[Any], NDArray[Any] | None, NDArray[Any]]
    """Stamps (ns), positions, rates, and the numbers of the messages that they are from."""

_TYPE = 'sensor_msgs/msg/JointState'
_OURS = (COMMAND.name, STROBE_READING.name)
"""Of this type, and no motion."""
_ORDERS = {b'\x00\x00': '>', b'\x00\x01': '<'}
"""Of bytes, by the head of a message; others are of encodings that nothing here reads."""
_STAMP = slice(4, 12)


@dataclass(frozen=True, kw_only=True, eq=False)
class JointSamples:
    """Samples of a joint in the order of recording, shape (N,) each."""

    stamps_ns: NDArray[np.int64]
    position: NDArray[np.float64]
    """rad."""
    rate: NDArray[np.float64] | None
    """rad/s; None where not every message has one."""
    defects: tuple[str, ...]
    """What is missing or damaged, a sentence each."""


def read_joint(path: Path, joint: str) -> JointSamples:
    """Read the samples of a joint.

    The time of a sample is that of its header; where headers carry none, that of recording.

    Parameters
    ----------
    path
        Folder of the bag, or a storage file.
    joint
        Its name; where several topics have it, that of the topic before it: `TOPIC:NAME`.

    Raises
    ------
    BagError
        There is no bag, or no such joint on one topic of it.

    """
    files = BagFiles(path)
    by_topic: dict[str, _Topic] = {}
    try:
        for file in files.files:
            for piece in file.scan_tables():
                if piece.type == _TYPE and piece.topic not in _OURS:
                    stamps = piece.stamps_ns if isinstance(piece, StoredTable) else np.array([piece.stamp_ns])
                    by_topic.setdefault(piece.topic, _Topic()).pieces.append((stamps, piece.data))
    finally:
        files.close()
    topic, joint = _chosen(path, by_topic, joint)
    pieces = by_topic[topic].pieces
    recorded, table = np.concatenate([stamps for stamps, _ in pieces]), _one_table([data for _, data in pieces])
    columns = None if table is None else _from_table(table, joint)
    stamps, position, rate, kept = columns or _one_by_one([row for _, data in pieces for row in _rows(data)], joint)
    defects = [*files.defects, *(defect for file in files.files for defect in file.defects)]
    defects += [file.cut_off for file in files.files if file.cut_off is not None]
    if left_out := recorded.size - stamps.size:
        defects.append(f'{left_out} messages on {topic} are damaged or without {joint}, and left out')
    if not stamps.size:
        raise BagError(f'{path}: none of the {recorded.size} messages on {topic} has a position of {joint}')
    if not np.ptp(stamps):
        defects.append(f'the headers on {topic} carry no time: that of recording is taken')
        stamps = recorded[kept]
    return JointSamples(stamps_ns=stamps, position=position, rate=rate, defects=tuple(map(printable, defects)))


def joint_names(path: Path) -> list[str]:
    """Return the joints in a bag whose positions can be read, in the order of their names.

    Raises
    ------
    BagError
        There is no bag.

    """
    files, joints = BagFiles(path), _Joints()
    try:
        for file in files.files:
            for piece in file.scan_tables():
                if piece.type == _TYPE and piece.topic not in _OURS:
                    joints.add(piece.data)
    finally:
        files.close()
    return sorted(joints.names)


@dataclass
class _Joints:
    """The joints that messages name: a message need not name all, nor the same as the one before."""

    names: set[str] = field(default_factory=set)
    _latest: bytes | None = None
    """What stood between stamp and positions in the message that was looked into last."""

    def add(self, data: Any) -> None:
        """Look into a message, or the rows of a table."""
        if isinstance(data, bytes):
            self._add(data)
            return
        self._add(data[0].tobytes())
        latest = np.frombuffer(self._latest or b'', np.uint8)
        there = data[:, _STAMP.stop : _STAMP.stop + latest.size]
        for row in data if there.shape[1] < latest.size else data[(there != latest).any(axis=1)]:
            self._add(row.tobytes())

    def _add(self, raw: bytes) -> None:
        if self._latest is not None and raw.startswith(self._latest, _STAMP.stop):
            return
        try:
            names, at = _named(raw)
        except (struct.error, UnicodeDecodeError, ValueError):
            return
        self.names.update(names)
        self._latest = raw[_STAMP.stop : at]


@dataclass
class _Topic:
    """The messages on a topic."""

    pieces: list[tuple[NDArray[Any], Any]] = field(default_factory=list)
    """Stamps and messages in pieces: a table, or one message."""

    def has(self, joint: str) -> bool:
        """Whether a message names the joint; mostly the first does."""
        return joint in self.joints(1) or joint in self.joints()

    def joints(self, pieces: int | None = None) -> set[str]:
        """Return the joints that the messages name, or those in so many pieces."""
        found = _Joints()
        for _, data in self.pieces[:pieces]:
            found.add(data)
        return found.names


def _chosen(path: Path, by_topic: dict[str, _Topic], joint: str) -> tuple[str, str]:
    """Return the topic and the name of the joint that is meant."""
    found = [(topic, joint) for topic, each in by_topic.items() if each.has(joint)]
    before, _, name = joint.rpartition(':')
    topic = before.removeprefix('/')
    if not found and topic in by_topic and by_topic[topic].has(name):
        found = [(topic, name)]
    if not found:
        there = ', '.join(sorted({each for topic in by_topic.values() for each in topic.joints()}))
        none = 'none whose messages can be read' if by_topic else f'none, as it has no {_TYPE} but those of a rig'
        raise BagError(f'{path} has no joint {joint}: {there or none}')
    if len(found) > 1:
        ways = ' or '.join(f'{topic}:{joint}' for topic, _ in found)
        raise BagError(f'{path} has {joint} on {", ".join(topic for topic, _ in found)}: name the joint as {ways}')
    return found[0]


def _rows(data: Any) -> list[bytes]:
    return [data] if isinstance(data, bytes) else [row.tobytes() for row in data]


def _one_table(pieces: list[Any]) -> NDArray[np.uint8] | None:
    """Return all messages as a table; None where they are not of one size."""
    sizes = {len(piece) if isinstance(piece, bytes) else piece.shape[1] for piece in pieces}
    if len(sizes) != 1:
        return None
    tables: list[NDArray[np.uint8]] = []
    for single, group in groupby(pieces, key=lambda piece: isinstance(piece, bytes)):
        alike = list(group)
        tables += [np.frombuffer(b''.join(alike), np.uint8).reshape(-1, *sizes)] if single else alike
    return tables[0] if len(tables) == 1 else np.concatenate(tables)


def _from_table(table: NDArray[np.uint8], joint: str) -> _Columns | None:
    """Read messages that all have the layout of the first, as they do of one writer; None where one has another."""
    first = table[0].tobytes()
    try:
        names, at_position, at_rate, counts = _layout(first)
        column = names.index(joint)
    except (struct.error, UnicodeDecodeError, ValueError):
        return None
    # All but the stamp and the values has to be the same: names and how many values there are.
    fixed = [slice(0, _STAMP.start), slice(_STAMP.stop, at_position), *(slice(at, at + 4) for at in counts)]
    if any((table[:, part] != table[0, part]).any() for part in fixed):
        return None
    seconds, nanoseconds = table[:, 4:8].copy().view('<i4')[:, 0], table[:, 8:12].copy().view('<u4')[:, 0]
    stamps = seconds.astype(np.int64) * SECOND + nanoseconds
    rate = _doubles(table, at_rate, column) if at_rate else None
    return stamps, _doubles(table, at_position, column), rate, np.arange(len(table))


def _doubles(table: NDArray[np.uint8], at: int, column: int) -> NDArray[np.float64]:
    begin = at + 8 * column
    return np.array(table[:, begin : begin + 8].copy().view('<f8')[:, 0])


def _layout(raw: bytes) -> tuple[list[str], int, int | None, list[int]]:
    """Return the names in a message, where positions and rates begin, and where it says how many there are."""
    names, at = _named(raw)
    count = len(names)
    if _ORDERS[raw[:2]] != '<':
        raise ValueError('these are read one by one')
    places, counts = [], []
    for _ in range(2):
        at += aligned(at, 4)
        (values,) = struct.unpack_from('<I', raw, at)
        counts.append(at)
        at += 4
        if values:
            at += aligned(at - 4, 8)
        places.append(at if values == count else None)
        at += 8 * values
    if places[0] is None or at > len(raw):
        raise ValueError('no position of each joint')
    return names, places[0], places[1], counts


def _named(raw: bytes) -> tuple[list[str], int]:
    """Return the names in a message, and where they end."""
    if raw[:2] not in _ORDERS:
        raise ValueError(f'an encoding {raw[:2].hex()}')
    whole, at = struct.Struct(f'{_ORDERS[raw[:2]]}I'), _STAMP.stop
    (length,) = whole.unpack_from(raw, at)
    at += 4 + length
    at += aligned(at, 4)
    (count,) = whole.unpack_from(raw, at)
    if count > len(raw):
        raise ValueError(count)
    at += 4
    names = []
    for _ in range(count):
        at += aligned(at, 4)
        (length,) = whole.unpack_from(raw, at)
        names.append(raw[at + 4 : at + 3 + length].decode())
        at += 4 + length
    return names, at


def _one_by_one(raws: list[bytes], joint: str) -> _Columns:
    rows = []
    for number, raw in enumerate(raws):
        try:
            if raw[:2] not in _ORDERS:
                continue
            message = deserialise(_TYPE, raw)
            time = message.header.stamp
            column = message.name.index(joint)
            rate = float(message.velocity[column]) if len(message.velocity) > column else None
            rows.append((time.sec * SECOND + time.nanosec, float(message.position[column]), rate, number))
        except (WireError, ValueError, IndexError):
            continue
    rates = [row[2] for row in rows]
    all_rates = None if None in rates else np.array(rates, np.float64)
    return (
        np.array([row[0] for row in rows], np.int64),
        np.array([row[1] for row in rows], np.float64),
        all_rates,
        np.array([row[3] for row in rows], np.int64),
    )
