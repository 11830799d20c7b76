"""Records of an MCAP file, none of which is what it says until that has been checked."""

from __future__ import annotations

import struct
from io import BytesIO
from typing import TYPE_CHECKING, Any, NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode

if TYPE_CHECKING:
    from collections.abc import Iterator

HEAD = struct.Struct('<BQ')
"""Opcode and size of a record."""
_CHUNK = struct.Struct('<16xQII')
_LENGTH = struct.Struct('<Q')
_CHUNK_INDEX = struct.Struct('<16xQQI')
_PACKED, _SIZES = struct.Struct('<8xI'), struct.Struct('<QQ')
_CHANNEL = struct.Struct('<HQ')
BEFORE_DATA = 22
"""Bytes of a message's own record before what was recorded."""


class DamageError(ValueError):
    """The bytes at some place are no record."""


class PackedChunk(NamedTuple):
    """A chunk as it stands in a file."""

    data: bytes
    compression: str
    size: int
    """Bytes when unpacked, as it says."""
    crc: int


class IndexedChunk(NamedTuple):
    """A chunk as the index at the end of a file has it."""

    start: int
    size: int
    """Of its record, bytes."""
    only_channel: int | None
    """Of its messages; None where they have several, or it has none."""
    compression: str
    packed: int
    """Bytes that it has in the file."""
    unpacked: int

    @property
    def content_at(self) -> int:
        """Where its content begins in the file."""
        return self.start + HEAD.size + _CHUNK.size + len(self.compression) + _LENGTH.size


def records(content: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield opcode and content of records that lie side by side.

    Raises
    ------
    DamageError
        One of them is cut off.

    """
    at = 0
    while at < len(content):
        if at + HEAD.size > len(content):
            raise DamageError('a record is cut off')
        op, size = HEAD.unpack_from(content, at)
        at += HEAD.size + size
        if at > len(content):
            raise DamageError('a record is cut off')
        yield op, content[at - size : at]


def messages_in(content: bytes) -> Iterator[slice]:
    """Yield where in an unpacked chunk the data of each message lie.

    Raises
    ------
    DamageError
        A record is cut off.

    """
    at = 0
    for op, body in records(content):
        at += HEAD.size + len(body)
        if op == Opcode.MESSAGE:
            yield slice(at - len(body) + BEFORE_DATA, at)


def parse_chunk(body: bytes) -> PackedChunk:
    """Read a chunk; what the package `mcap` has for it takes ten times as long.

    Raises
    ------
    DamageError
        It is none.

    """
    try:
        size, crc, length = _CHUNK.unpack_from(body)
        begin = _CHUNK.size + length
        compression = body[_CHUNK.size : begin].decode()
        (there,) = _LENGTH.unpack_from(body, begin)
    except (struct.error, UnicodeDecodeError) as error:
        raise DamageError('a Chunk is none') from error
    begin += _LENGTH.size
    if begin + there > len(body):
        raise DamageError('a Chunk is none')
    return PackedChunk(body[begin : begin + there], compression, size, crc)


def parse_chunk_index(body: bytes) -> IndexedChunk:
    """Read the index of a chunk; see `parse_chunk`."""
    try:
        start, size, length = _CHUNK_INDEX.unpack_from(body)
        at = _CHUNK_INDEX.size + length
        only = _CHANNEL.unpack_from(body, _CHUNK_INDEX.size)[0] if length == _CHANNEL.size else None
        (name,) = _PACKED.unpack_from(body, at)
        at += _PACKED.size + name
        compression = body[at - name : at].decode()
        return IndexedChunk(start, size, only, compression, *_SIZES.unpack_from(body, at))
    except (struct.error, UnicodeDecodeError) as error:
        raise DamageError('a ChunkIndex is none') from error


def parse(kind: Any, body: bytes) -> Any:
    """Read a record as the package `mcap` does.

    Parameters
    ----------
    kind
        A class of `mcap.records`.
    body
        Content of the record.

    Raises
    ------
    DamageError
        It is none.

    """
    try:
        return kind.read(ReadDataStream(BytesIO(body)))
    except (McapError, ValueError, struct.error, KeyError, OverflowError, MemoryError) as error:
        raise DamageError(f'a {kind.__name__} is none') from error
