"""The writer of rosbags, for any name of a folder, and at a third of its cost.

It goes through storage objects of rosbags that are not its public interface, which is why its version is pinned.
"""

from __future__ import annotations

import sqlite3
from types import FunctionType
from typing import TYPE_CHECKING, Any, TypeVar

from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Writer

from kapitsa_ros.recording.mcap_storage import McapStorage
from kapitsa_ros.recording.metadata_yaml import MetadataYaml

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from rosbags.rosbag2 import CompressionMode

Method = TypeVar('Method', bound='Callable[..., Any]')


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
