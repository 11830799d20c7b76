"""An MCAP file, read from front to end: what is there counts, whether or not it has an index.

The records are those of the `mcap` package; its readers want a whole file, or give up at the first damage.
"""

from __future__ import annotations

import os
import struct
from array import array
from collections import OrderedDict
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np
import zstandard
from mcap.opcode import Opcode
from mcap.records import Channel, Footer, Metadata, Schema

from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.storage.decompression import (
    LARGEST,
    ZSTD_MAGIC,
    DecompressionError,
    unpack_chunk,
    unpack_message,
)
from kapitsa_ros.recording.storage.mcap_records import (
    HEAD,
    DamageError,
    IndexedChunk,
    parse,
    parse_chunk,
    parse_chunk_index,
    records,
)
from kapitsa_ros.recording.storage.stored_message import StoredMessage, StoredTable

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from typing import BinaryIO

MAGIC = b'\x89MCAP0\r\n'
_MESSAGE = struct.Struct('<HIQQ')
_CHANNEL = struct.Struct('<H')
_FOOTER_SIZE = HEAD.size + 20
_KEPT, _OVERHEAD = 2**25, 200
"""Bytes of unpacked chunks that are kept, and what each costs besides."""
_OUTSIDE = -1
"""Block of a message in no chunk."""


class McapFile:
    """An MCAP file; see `StorageFile`.

    Raises
    ------
    BagError
        It cannot be opened.

    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.finished = False
        self.metadata: str | None = None
        self.storage = 'mcap'
        self.defects: list[str] = []
        self.cut_off: str | None = None
        self._schemas: dict[int, str] = {}
        self._channels: dict[int, tuple[str, str]] = {}
        self._chunks: OrderedDict[int, bytes] = OrderedDict()
        self._kept = 0
        self._file: BinaryIO | None = None
        try:
            self._size = path.stat().st_size
        except OSError as error:
            raise BagError(f'{path} cannot be read: {error.strerror}') from error

    def close(self) -> None:
        """Leave the file; whoever reads again opens it again."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def scan(self) -> Iterator[StoredMessage]:
        """Yield all messages that can be read, in the order of recording."""
        for op, at, body in self._records():
            yield from self._messages(op, at, body)

    def scan_tables(self) -> Iterator[StoredMessage | StoredTable]:
        """Yield the same, a chunk as a table where all its messages are of one topic and size."""
        for op, at, body in self._records():
            table = None
            if op == Opcode.CHUNK:
                with suppress(DamageError, DecompressionError):
                    table = self._as_table(self._unpacked(body))
            if table is None:
                yield from self._messages(op, at, body)
            else:
                yield table

    def chunks_of(self, topic: str) -> Iterator[bytes | bytearray]:
        """Yield the content of the chunks that the index has for one topic alone; the next may overwrite it.

        Nothing is checked: whoever knows what there has to be can tell by that.

        Raises
        ------
        ValueError
            A chunk is damaged.

        """
        unpacker, buffer = zstandard.ZstdDecompressor(), bytearray()
        known: set[int] = set()
        end = 0
        for indexed in self._summary():
            known = known or {number for number, (name, _) in self._channels.items() if name == topic}
            if indexed.only_channel not in known:
                continue
            at, size = indexed.content_at, indexed.packed
            if not end <= at <= self._size - size or size > LARGEST:
                raise DamageError('a chunk is not where the index has it')
            end = at + size
            if indexed.compression:
                yield unpack_chunk(self._bytes(at, size), indexed.compression, indexed.unpacked, 0, unpacker)
                continue
            if len(buffer) != size:
                buffer = bytearray(size)
            self._fill(buffer, at)
            yield buffer

    def _records(self) -> Iterator[tuple[int, int, bytes]]:
        """Yield opcode, place and content of the records that can be read."""
        if self._bytes(0, len(MAGIC)) != MAGIC:
            raise BagError(f'{self.path} is no MCAP file')
        starts = array('q', (chunk.start for chunk in self._summary() if chunk.start < self._size))
        at = len(MAGIC)
        while at < self._size:
            try:
                op, body = self._record(at)
            except DamageError as error:
                onward = min((start for start in starts if start > at), default=None)
                if not self.finished:
                    self.cut_off = (
                        f'it was never closed, and ends in the middle of a record, at byte {at} of {self._size}'
                    )
                    return
                self.defects.append(f'{self.path.name}: {error} at byte {at} of {self._size}')
                if onward is None:
                    return
                at = onward
                continue
            if op in (Opcode.DATA_END, Opcode.FOOTER):
                return
            yield op, at, body
            at += HEAD.size + len(body)

    def read(self, block: int, at: int) -> bytes:
        """Return the data of a message at its place."""
        if block == _OUTSIDE:
            return unpack_message(self._record(at)[1][_MESSAGE.size :])
        if block not in self._chunks:
            self._keep(block, self._unpacked(self._record(block)[1]))
        self._chunks.move_to_end(block)
        content = self._chunks[block]
        _, size = HEAD.unpack_from(content, at)
        return unpack_message(content[at + HEAD.size + _MESSAGE.size : at + HEAD.size + size])

    def _messages(self, op: int, at: int, body: bytes) -> Iterator[StoredMessage]:
        try:
            if op == Opcode.MESSAGE:
                yield self._message(_OUTSIDE, at, body)
            elif op == Opcode.CHUNK:
                content = self._unpacked(body)
                self._keep(at, content)
                yield from self._in_chunk(at, content)
            else:
                self._take(op, body)
        except (DamageError, DecompressionError) as error:
            self.defects.append(f'{self.path.name}: the record at byte {at} is damaged and left out: {error}')

    def _as_table(self, content: bytes) -> StoredTable | None:
        """Return a chunk's messages, if they are all of one topic and size; damage is for others to find."""
        at = 0
        try:
            while content[at : at + 1] not in (bytes([Opcode.MESSAGE]), b''):
                op, size = HEAD.unpack_from(content, at)
                self._take(op, content[at + HEAD.size : at + HEAD.size + size])
                at += HEAD.size + size
            _, size = HEAD.unpack_from(content, at)
            (channel,) = _CHANNEL.unpack_from(content, at + HEAD.size)
        except (DamageError, struct.error):
            return None
        stride, same = HEAD.size + size, HEAD.size + _CHANNEL.size
        if size < _MESSAGE.size or (len(content) - at) % stride or channel not in self._channels:
            return None
        rows = np.frombuffer(content, np.uint8, offset=at).reshape(-1, stride)
        data = rows[:, HEAD.size + _MESSAGE.size :]
        packed = content[at + HEAD.size + _MESSAGE.size :].startswith(ZSTD_MAGIC)
        if packed or (rows[:, :same] != rows[0, :same]).any():
            return None
        stamps = rows[:, same + 4 : same + 12].copy().view('<i8')[:, 0]
        return StoredTable(*self._channels[channel], stamps, data)

    def _in_chunk(self, block: int, content: bytes) -> Iterator[StoredMessage]:
        at = 0
        while at < len(content):
            if at + HEAD.size > len(content):
                raise DamageError('a record in it is cut off')
            op, size = HEAD.unpack_from(content, at)
            begin = at + HEAD.size
            if begin + size > len(content):
                raise DamageError('a record in it is longer than the chunk')
            if op == Opcode.MESSAGE:
                yield self._message(block, at, content[begin : begin + size])
            else:
                self._take(op, content[begin : begin + size])
            at = begin + size

    def _message(self, block: int, at: int, body: bytes) -> StoredMessage:
        if len(body) < _MESSAGE.size:
            raise DamageError('a message in it is cut off')
        channel, _, stamp, _ = _MESSAGE.unpack_from(body)
        if channel not in self._channels:
            raise DamageError(f'no topic is known for channel {channel}')
        topic, kind = self._channels[channel]
        return StoredMessage(topic, kind, stamp, block, at, unpack_message(body[_MESSAGE.size :]))

    def _take(self, op: int, body: bytes) -> None:
        """Note what a record says of the messages."""
        if op == Opcode.SCHEMA:
            schema: Schema = parse(Schema, body)
            self._schemas[schema.id] = schema.name
        elif op == Opcode.CHANNEL:
            channel: Channel = parse(Channel, body)
            kind = self._schemas.get(channel.schema_id, '')
            self._channels[channel.id] = (channel.topic.removeprefix('/'), kind)
        elif op == Opcode.METADATA:
            found: Metadata = parse(Metadata, body)
            if found.name == 'rosbag2':
                self.metadata = found.metadata.get('serialized_metadata')

    def _summary(self) -> Iterator[IndexedChunk]:
        """Read the index at the end, if there is one, and yield the chunks that it has."""
        self.finished = self._bytes(self._size - len(MAGIC), len(MAGIC)) == MAGIC and self._size > len(MAGIC)
        if not self.finished:
            return
        end = self._size - len(MAGIC) - _FOOTER_SIZE
        try:
            _, body = self._record(end)
            footer: Footer = parse(Footer, body)
            begin = footer.summary_start
            summary = self._bytes(begin, end - begin) if 0 < begin < end < begin + LARGEST else b''
            for op, body in records(summary):
                if op == Opcode.CHUNK_INDEX:
                    yield parse_chunk_index(body)
                else:
                    self._take(op, body)
        except DamageError:
            self.defects.append(f'{self.path.name}: its index is damaged')

    def _record(self, at: int) -> tuple[int, bytes]:
        head = self._bytes(at, HEAD.size)
        if len(head) < HEAD.size:
            raise DamageError('a record is cut off')
        op, size = HEAD.unpack(head)
        if at + HEAD.size + size > self._size:
            raise DamageError('a record is longer than the file')
        if not op or size > 2 * LARGEST:
            raise DamageError('a record cannot be')
        return op, self._bytes(at + HEAD.size, size)

    @staticmethod
    def _unpacked(body: bytes) -> bytes:
        return unpack_chunk(*parse_chunk(body))

    def _keep(self, block: int, content: bytes) -> None:
        if block not in self._chunks:
            self._chunks[block] = content
            self._kept += len(content) + _OVERHEAD
        while len(self._chunks) > 1 and self._kept > _KEPT:
            self._kept -= len(self._chunks.popitem(last=False)[1]) + _OVERHEAD

    def _bytes(self, at: int, size: int) -> bytes:
        try:
            file = self._opened
            file.seek(max(at, 0))
            return file.read(size)
        except OSError as error:
            raise BagError(f'{self.path} cannot be read: {error.strerror}') from error

    def _fill(self, buffer: bytearray, at: int) -> None:
        try:
            filled = os.preadv(self._opened.fileno(), [buffer], at)
        except OSError as error:
            raise BagError(f'{self.path} cannot be read: {error.strerror}') from error
        if filled < len(buffer):
            raise DamageError('a chunk is cut off')

    @property
    def _opened(self) -> BinaryIO:
        if self._file is None:
            self._file = self.path.open('rb')
        return self._file
