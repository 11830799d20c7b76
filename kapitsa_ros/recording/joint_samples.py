"""The angle of a joint in anybody's bag, from sensor_msgs/JointState."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros.network.cdr import aligned, stamp_of
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
_LITTLE_ENDIAN = b'\x00\x01'
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

    Raises
    ------
    BagError
        There is no bag, or no such joint on one topic of it.

    """
    files = BagFiles(path)
    by_topic: dict[str, list[tuple[NDArray[Any], Any]]] = {}
    """Stamps and messages in pieces: a table, or one message."""
    try:
        for file in files.files:
            for piece in file.scan_tables():
                if piece.type == _TYPE and piece.topic not in _OURS:
                    stamps = piece.stamps_ns if isinstance(piece, StoredTable) else np.array([piece.stamp_ns])
                    by_topic.setdefault(piece.topic, []).append((stamps, piece.data))
    finally:
        files.close()
    found = {topic: each for topic, each in by_topic.items() if joint in _names(each)}
    if len(found) != 1:
        there = sorted({name for each in by_topic.values() for name in _names(each)})
        what = f'has {joint} on {", ".join(found)}' if found else f'has no joint {joint}: {", ".join(there) or "none"}'
        raise BagError(f'{path} {what}')
    [(topic, pieces)] = found.items()
    recorded, table = np.concatenate([stamps for stamps, _ in pieces]), _one_table([data for _, data in pieces])
    columns = None if table is None else _from_table(table, joint)
    stamps, position, rate, kept = columns or _one_by_one([row for _, data in pieces for row in _rows(data)], joint)
    defects = [*files.defects, *(defect for file in files.files for defect in file.defects)]
    defects += [file.cut_off for file in files.files if file.cut_off is not None]
    if left_out := recorded.size - stamps.size:
        defects.append(f'{left_out} messages on {topic} are damaged or without {joint}, and left out')
    if not stamps.size or not np.ptp(stamps):
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
    files = BagFiles(path)
    by_topic: dict[str, list[str]] = {}
    try:
        for file in files.files:
            for piece in file.scan_tables():
                if piece.type == _TYPE and piece.topic not in {*_OURS, *by_topic}:
                    by_topic[piece.topic] = _names([(np.empty(0), piece.data)])
    finally:
        files.close()
    return sorted({name for names in by_topic.values() for name in names})


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


def _names(pieces: list[tuple[NDArray[Any], Any]]) -> list[str]:
    """Return the joints of the first message that is one."""
    for _, data in pieces:
        try:
            return list(deserialise(_TYPE, data if isinstance(data, bytes) else data[0].tobytes()).name)
        except WireError:
            continue
    return []


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
    if first[:2] != _LITTLE_ENDIAN or any((table[:, part] != table[0, part]).any() for part in fixed):
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
    at = 12
    (length,) = struct.unpack_from('<I', raw, at)
    at += 4 + length
    at += aligned(at, 4)
    (count,) = struct.unpack_from('<I', raw, at)
    if count > len(raw):
        raise ValueError(count)
    at += 4
    names = []
    for _ in range(count):
        at += aligned(at, 4)
        (length,) = struct.unpack_from('<I', raw, at)
        names.append(raw[at + 4 : at + 3 + length].decode())
        at += 4 + length
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


def _one_by_one(raws: list[bytes], joint: str) -> _Columns:
    rows = []
    for number, raw in enumerate(raws):
        try:
            message = deserialise(_TYPE, raw)
            column = message.name.index(joint)
            rate = float(message.velocity[column]) if len(message.velocity) > column else None
            rows.append((stamp_of(raw), float(message.position[column]), rate, number))
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
