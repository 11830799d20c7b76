"""Writing a run: steps in order, stamped in simulated time, on disk every few steps."""

from __future__ import annotations

import sqlite3
from contextlib import suppress
from typing import TYPE_CHECKING

from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer, WriterError
from rosbags.typesys import Stores, get_typestore

from kapitsa_ros.network.registry import RECORDED
from kapitsa_ros.network.settings import SETTINGS_TYPE, encode_settings, settings_topic
from kapitsa_ros.recording.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from rosbags.interfaces import Connection

STORAGES = ('mcap', 'sqlite3')
FORMAT = 1
"""Of the bags written; those that came before it say none. A reader takes its own and what came before."""
FORMAT_KEY, COMPLETE = 'format', 'complete'
"""Keys of the bag's custom data; `complete` is `true` once the end of the run has been written."""
_FOREVER = QosTime(9223372036, 854775807)
_STORE = get_typestore(Stores.ROS2_JAZZY)


def _qos(history: QosHistory, depth: int, durability: QosDurability) -> Qos:
    return Qos(
        history, depth, QosReliability.RELIABLE, durability, _FOREVER, _FOREVER,
        QosLiveliness.AUTOMATIC, _FOREVER, avoid_ros_namespace_conventions=False,
    )  # fmt: skip


_STREAM = _qos(QosHistory.KEEP_ALL, 0, QosDurability.VOLATILE)
_LATCHED = _qos(QosHistory.KEEP_LAST, 1, QosDurability.TRANSIENT_LOCAL)


class RunWriter:
    """Writes the bag of one run.

    Parameters
    ----------
    path
        Folder of the bag; it must not exist.
    storage
        `mcap` or `sqlite3`.
    settings
        JSON text by node.
    steps_a_chunk
        So many steps are lost at most when the machine stops.

    Raises
    ------
    BagError
        The folder exists or cannot be written.

    """

    def __init__(self, path: Path, storage: str, settings: Mapping[str, str], steps_a_chunk: int) -> None:
        self.path = path
        self._settings = settings
        self._steps_a_chunk = steps_a_chunk
        self._steps = 0
        try:
            self._writer = Writer(path, version=9, storage_plugin=StoragePlugin[storage.upper()])
            if storage == 'mcap':
                self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
            self._writer.open()
        except (WriterError, OSError, sqlite3.Error) as error:
            raise BagError(f'cannot write {path}: {error}') from error
        self._latched = {
            node: self._connect(settings_topic(node), SETTINGS_TYPE, _LATCHED) for node in sorted(settings)
        }
        self._connections = {topic.name: self._connect(topic.name, topic.type, _STREAM) for topic in RECORDED}

    def write_step(self, stamp_ns: int, messages: Mapping[str, bytes]) -> None:
        """Write the messages of one step, by topic.

        Raises
        ------
        BagError
            The disk does not take them.

        """
        try:
            if not self._steps:
                for node, connection in self._latched.items():
                    self._writer.write(connection, stamp_ns, encode_settings(self._settings[node]))
            for topic, connection in self._connections.items():
                if topic in messages:
                    self._writer.write(connection, stamp_ns, messages[topic])
            self._steps += 1
            if self._steps % self._steps_a_chunk == 0:
                self._flush()
        except (OSError, sqlite3.Error) as error:
            raise BagError(f'cannot write {self.path}: {error}') from error

    def close(self, *, complete: bool) -> None:
        """Finish the bag, so that any rosbag2 reader takes it; say in it whether the run came to its end."""
        self._writer.set_custom_data(FORMAT_KEY, str(FORMAT))
        self._writer.set_custom_data(COMPLETE, str(complete).lower())
        try:
            self._writer.close()
        except (OSError, sqlite3.Error) as error:
            raise BagError(f'cannot finish {self.path}: {error}') from error

    def abort(self) -> None:
        """Leave what is on disk as it is, without an index: nobody will take it for a whole bag."""
        with suppress(OSError, sqlite3.Error):
            self._writer.abort()

    def _connect(self, topic: str, kind: str, qos: Qos) -> Connection:
        return self._writer.add_connection(f'/{topic}', kind, typestore=_STORE, offered_qos_profiles=[qos])

    def _flush(self) -> None:
        """Put what has been written on disk: rosbags does so by size only, and has no call for it."""
        storage = self._writer.storage
        if self._writer.storage_plugin is StoragePlugin.MCAP:
            storage.close_chunk()  # type: ignore[union-attr]
            storage.bio.flush()  # type: ignore[union-attr]
        else:
            storage.conn.commit()  # type: ignore[union-attr]
