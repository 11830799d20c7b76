"""Writing a run: steps in order, stamped in simulated time, given to the disk every few steps."""

from __future__ import annotations

import sqlite3
import time
from contextlib import suppress
from typing import TYPE_CHECKING

from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, WriterError
from rosbags.typesys import Stores, get_typestore

from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.registry import MOTION, RECORDED
from kapitsa_ros.network.settings import SETTINGS_TYPE, encode_settings, settings_topic
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.recording.bag_writer import BagWriter
from kapitsa_ros.recording.digest import DIGEST_KEY, DIGEST_TOPIC, LAST_GROUP_KEY, MOTION_KEY, RunDigest
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.motion_digest import MotionDigest
from kapitsa_ros.recording.processor import PROCESSOR_KEY, processor_text
from kapitsa_ros.recording.storage_control import STORAGE_CONTROLS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from rosbags.interfaces import Connection

    from kapitsa_ros.network.step_id import StepId

STORAGES = tuple(STORAGE_CONTROLS)
COMPRESSIONS = {'zstd': CompressionMode.STORAGE, 'none': CompressionMode.NONE}
"""Of the chunks of MCAP."""
FORMAT = 2
"""Of the bags written; those that came before it say none. A reader takes its own and what came before."""
FORMAT_KEY, COMPLETE = 'format', 'complete'
"""Keys of the bag's custom data; `complete` is `true` once the end of the run has been written."""
_LONGEST_CHUNK = SECOND // 2
"""Simulated ns that are kept back at most; a process that is killed loses them."""
_SYNC_PERIOD = 1.0
"""Seconds of wall time after which what was given to the disk must be on it, whatever happens to the machine."""
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
        So many steps are kept back at most, and no more than half a simulated second.
    compression
        Of the chunks of MCAP: `zstd` or `none`; sqlite3 has none.
    clock
        Wall time in seconds; tells when to put on disk what was given to it.
    processor
        On which the run was computed, where that is not this one (empty: nobody knows); see `processor_text`.

    Raises
    ------
    BagError
        The folder exists or cannot be written.

    """

    def __init__(
        self,
        path: Path,
        storage: str,
        settings: Mapping[str, str],
        steps_a_chunk: int,
        *,
        compression: str = 'zstd',
        clock: Callable[[], float] = time.monotonic,
        processor: str | None = None,
    ) -> None:
        self.path = path
        self._processor = processor_text() if processor is None else processor
        self._settings = settings
        self._steps_a_chunk = steps_a_chunk
        self._steps = 0
        self._in_chunk = 0
        self._chunk_begin = self._last_stamp = 0
        self._digest = RunDigest(settings)
        self._last_id: StepId | None = None
        self._gapless = True
        self._motion = MotionDigest()
        self._clock = clock
        self._synced_at, self._to_sync = clock(), False
        try:
            self._writer = BagWriter(path, version=9, storage_plugin=StoragePlugin[storage.upper()])
            if storage == 'mcap':
                self._writer.set_compression(COMPRESSIONS[compression], CompressionFormat.ZSTD)
            self._writer.open()
            self._storage = STORAGE_CONTROLS[storage](self._writer)
        except (WriterError, OSError, sqlite3.Error) as error:
            raise BagError(f'cannot write {path}: {error}') from error
        self._latched = {
            node: self._connect(settings_topic(node), SETTINGS_TYPE, _LATCHED) for node in sorted(settings)
        }
        self._connections = {topic.name: self._connect(topic.name, topic.type, _STREAM) for topic in RECORDED}
        self._digests = self._connect(DIGEST_TOPIC, SETTINGS_TYPE, _STREAM)

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
                self._last_stamp = stamp_ns
            if not self._in_chunk:
                self._chunk_begin = stamp_ns
            for topic, connection in self._connections.items():
                if topic in messages:
                    self._storage.write(connection, stamp_ns, messages[topic], apart=topic == MOTION.name)
            step_id = read_step_id(next(iter(messages.values())))
            self._gapless = self._gapless and step_id.follows(self._last_id) and MOTION.name in messages
            self._last_id = step_id
            if self._gapless and not step_id.end:
                self._motion.add(messages[MOTION.name])
            self._digest.add(step_id, messages)
            self._steps += 1
            self._in_chunk += 1
            with_next = stamp_ns - self._chunk_begin + 2 * (stamp_ns - self._last_stamp)
            self._last_stamp = stamp_ns
            if self._in_chunk >= self._steps_a_chunk or with_next > _LONGEST_CHUNK:
                self._flush(stamp_ns)
            self.sync()
        except (OSError, sqlite3.Error) as error:
            raise BagError(f'cannot write {self.path}: {error}') from error

    def sync(self) -> float:
        """Put on disk what was given to it a second ago; return in how many seconds that is due again.

        Raises
        ------
        BagError
            The disk does not take it.

        """
        if not self._to_sync:
            return _SYNC_PERIOD
        wait = self._synced_at + _SYNC_PERIOD - self._clock()
        if wait > 0:
            return wait
        try:
            self._storage.sync()
        except OSError as error:
            raise BagError(f'cannot write {self.path}: {error}') from error
        self._synced_at, self._to_sync = self._clock(), False
        return _SYNC_PERIOD

    def close(self, *, complete: bool) -> None:
        """Finish the bag, so that any rosbag2 reader takes it; say in it whether the run came to its end.

        Raises
        ------
        BagError
            The disk does not take it.

        """
        try:
            self._write_digest(self._last_stamp)
            self._writer.set_custom_data(FORMAT_KEY, str(FORMAT))
            self._writer.set_custom_data(COMPLETE, str(complete).lower())
            self._writer.set_custom_data(DIGEST_KEY, self._digest.value)
            self._writer.set_custom_data(LAST_GROUP_KEY, self._digest.last_group)
            if self._processor:
                self._writer.set_custom_data(PROCESSOR_KEY, self._processor)
            self._storage.settle()
            if complete and self._gapless and (motion := self._motion.value) is not None:
                self._writer.set_custom_data(MOTION_KEY, motion)
            self._writer.close()
            self._storage.sync_closed()
        except (OSError, sqlite3.Error) as error:
            raise BagError(f'cannot finish {self.path}: {error}') from error
        self._storage.release()

    def abort(self) -> None:
        """Leave what is on disk as it is, without an index: nobody will take it for a whole bag."""
        with suppress(OSError, sqlite3.Error):
            self._writer.abort()
        self._storage.release()

    def _connect(self, topic: str, kind: str, qos: Qos) -> Connection:
        return self._writer.add_connection(f'/{topic}', kind, typestore=_STORE, offered_qos_profiles=[qos])

    def _flush(self, stamp_ns: int) -> None:
        """Give the disk what has been written, with its digest."""
        self._write_digest(stamp_ns)
        self._storage.flush()
        self._in_chunk = 0
        self._to_sync = True

    def _write_digest(self, stamp_ns: int) -> None:
        if (digest := self._digest.close_group()) is not None:
            self._writer.write(self._digests, stamp_ns, digest)
