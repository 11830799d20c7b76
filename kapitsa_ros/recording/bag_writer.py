"""The writer of rosbags, for any name of a folder, and at a third of its cost.

It goes through storage objects of rosbags that are not its public interface, which is why its version is pinned.
"""

from __future__ import annotations

import sqlite3
import struct
from types import FunctionType
from typing import TYPE_CHECKING, Any, TypeVar

import zstandard
from rosbags.rosbag2 import CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import McapWriter
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Writer

from kapitsa_ros.recording.metadata_yaml import MetadataYaml

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from rosbags.interfaces import Connection

Method = TypeVar('Method', bound='Callable[..., Any]')

_MESSAGE = struct.Struct('<BQHIQQ')
_MESSAGE_OPCODE, _BEFORE_DATA = 5, 22
_LARGEST_CHUNK = 2**20
_LEVEL = 1
"""Half the time of the usual one, and files larger by a fifteenth."""


class McapStorage(McapWriter):
    """As rosbags writes it, but for the time it takes: one call a message, one compressor a file.

    Parameters
    ----------
    path
        Folder of the bag.
    compression
        Chunks are packed by zstd, or not at all.

    """

    def __init__(self, path: Path, compression: CompressionMode) -> None:
        super().__init__(path, compression)
        self.on_chunk: Callable[[bytes], None] | None = None
        """Is called with the content of each chunk as it stands in the file."""
        self._pack = self.compressor
        if compression == CompressionMode.STORAGE:
            self._pack = zstandard.ZstdCompressor(level=_LEVEL).compress
        self.compressor = self._packed

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Write a message; timestamp in ns."""
        chunk, number = self.chunk, connection.id
        self.message_start_time = min(timestamp, self.message_start_time)
        self.message_end_time = max(timestamp, self.message_end_time)
        self.channel_stats[number] += 1
        chunk.message_start_time = min(timestamp, chunk.message_start_time)
        chunk.message_end_time = max(timestamp, chunk.message_end_time)
        chunk.msgs[number].append((timestamp, chunk.bio.tell()))
        size = _BEFORE_DATA + len(data)
        chunk.bio.write(_MESSAGE.pack(_MESSAGE_OPCODE, size, number, 0, timestamp, timestamp))
        chunk.bio.write(data)
        if chunk.bio.tell() > _LARGEST_CHUNK:
            self.close_chunk()

    def _packed(self, content: bytes) -> bytes:
        packed = self._pack(content)
        if self.on_chunk is not None:
            self.on_chunk(packed)
        return packed


class Sqlite3Storage(Sqlite3Writer):
    """As rosbags writes it; but rosbags takes a name with `?`, `#` or `%` for another one."""

    def __init__(self, path: Path, compression: CompressionMode) -> None:  # noqa: ARG002 - sqlite has none
        self.path = path / f'{path.name}_0.db3'
        self.conn = sqlite3.connect(self.path)
        self.conn.execute('PRAGMA journal_mode=WAL')
        self.conn.execute('PRAGMA synchronous=NORMAL')
        self.conn.executescript(self.SQLITE_SCHEMA)
        self.cursor = self.conn.cursor()


def _with_metadata_yaml(method: Method) -> Method:
    """Return a method of rosbags as it is, but for what it takes for `YAML`."""
    theirs: Any = method
    own: Any = FunctionType(theirs.__code__, theirs.__globals__ | {'YAML': MetadataYaml}, theirs.__name__)
    own.__kwdefaults__ = theirs.__kwdefaults__
    return own  # type: ignore[no-any-return]


class BagWriter(Writer):
    """The writer of rosbags with these storages."""

    close = _with_metadata_yaml(Writer.close)
    add_connection = _with_metadata_yaml(Writer.add_connection)

    STORAGE_PLUGINS: Mapping[StoragePlugin, Any] = {
        StoragePlugin.MCAP: McapStorage,
        StoragePlugin.SQLITE3: Sqlite3Storage,
    }
