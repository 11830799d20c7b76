"""What rosbags has no call for: the names that rosbag2 gives its files, and when they are on disk.

It goes through storage objects of rosbags that are not its public interface, which is why its version is pinned.
"""

from __future__ import annotations

import fcntl
import os
from abc import ABC, abstractmethod
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rosbags.interfaces import Connection
    from rosbags.rosbag2 import Writer


class StorageControl(ABC):
    """The storage file of an open writer.

    Parameters
    ----------
    writer
        Nothing has been written with it.

    """

    def __init__(self, writer: Writer) -> None:
        storage: Any = writer.storage
        self._writer, self._folder, self._storage = writer, Path(writer.path), storage
        old = Path(self._storage.path)
        self._path = old.with_name(f'{self._folder.name}_0{old.suffix}')
        self._rename(old)
        self._storage.path = self._path
        self._lock: int | None = _locked(self._folder)
        _sync_file(self._folder.parent)

    def write(self, connection: Connection, stamp_ns: int, raw: bytes, *, apart: bool) -> None:  # noqa: ARG002 - of MCAP
        """Write a message; `apart` from others, where the storage has a way to read them alone then."""
        self._writer.write(connection, stamp_ns, raw)

    def release(self) -> None:
        """Let others have the bag."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    @abstractmethod
    def flush(self) -> None:
        """Hand all that has been written over to the system: from then on it outlives the process."""

    @abstractmethod
    def sync(self) -> None:
        """Wait until what was handed over is on disk: from then on it outlives the machine."""

    @abstractmethod
    def settle(self) -> None:
        """Make one file of what was written, before the writer closes it."""

    @abstractmethod
    def _rename(self, old: Path) -> None:
        """Give the file its name, as rosbag2 does: `NAME_0`."""

    def sync_closed(self) -> None:
        """Wait until a bag that has been closed is on disk, its names included."""
        for path in (self._path, self._folder / 'metadata.yaml', self._folder, self._folder.parent):
            _sync_file(path)


class McapControl(StorageControl):
    """An MCAP file: what a chunk holds is handed over with it; what is written apart has chunks of its own.

    Parameters
    ----------
    writer
        Nothing has been written with it.

    """

    def __init__(self, writer: Writer) -> None:
        super().__init__(writer)
        self._apart: list[tuple[Connection, int, bytes]] = []

    def write(self, connection: Connection, stamp_ns: int, raw: bytes, *, apart: bool) -> None:
        """Write a message, or keep it until the chunk is closed."""
        if apart:
            self._apart.append((connection, stamp_ns, raw))
        else:
            self._writer.write(connection, stamp_ns, raw)

    def flush(self) -> None:
        """Close the chunk, and write that of the messages apart."""
        if self._storage.chunk.bio.tell():
            self._storage.close_chunk()
        if self._apart:
            for each in self._apart:
                self._writer.write(*each)
            self._storage.close_chunk()
            self._apart = []
        self._storage.bio.flush()

    def sync(self) -> None:
        """Wait for the disk."""
        os.fdatasync(self._storage.bio.fileno())

    def settle(self) -> None:
        """Write what was kept."""
        self.flush()

    def _rename(self, old: Path) -> None:
        old.rename(self._path)


class Sqlite3Control(StorageControl):
    """A file of sqlite3, with a write-ahead log: what is committed is in one of both, whatever is killed.

    Sqlite itself syncs when it moves the log into the file, and never in between.
    """

    def flush(self) -> None:
        """Commit."""
        self._storage.conn.commit()

    def sync(self) -> None:
        """Wait for the disk."""
        log = Path(f'{self._path}-wal')  # some file systems allow none
        descriptor = os.open(log if log.exists() else self._path, os.O_RDONLY)
        try:
            os.fdatasync(descriptor)
        finally:
            os.close(descriptor)

    def settle(self) -> None:
        """Move the log into the file, and leave none."""
        self._storage.conn.commit()
        self._storage.conn.execute('PRAGMA journal_mode=DELETE')

    def _rename(self, old: Path) -> None:
        """Do nothing: it was made under its name."""


STORAGE_CONTROLS: dict[str, type[StorageControl]] = {'mcap': McapControl, 'sqlite3': Sqlite3Control}
"""By the name that rosbag2 has for a storage."""


def is_being_recorded(folder: Path) -> bool:
    """Whether a recorder is at work on a bag."""
    lock = _locked(folder)
    if lock is None:
        return True
    os.close(lock)
    return False


def _locked(folder: Path) -> int | None:
    """Return a descriptor that keeps a folder for this process; None: another has it."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        return None
    except OSError:
        pass  # a file system without locks
    return descriptor


def _sync_file(path: Path) -> None:
    """Put a file or a folder on disk; folders of some file systems cannot be synced."""
    with suppress(OSError):
        descriptor = os.open(path, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
