"""A bag file of sqlite3, together with the journal that a recorder which was killed has left beside it."""

from __future__ import annotations

import shutil
import sqlite3
import tempfile
import weakref
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.storage.decompression import LARGEST, DecompressionError, unpack_message
from kapitsa_ros.recording.storage.stored_message import StoredMessage

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kapitsa_ros.recording.storage.stored_message import StoredTable

MAGIC = b'SQLite format 3\x00'
JOURNALS = ('-wal', '-journal')
_ERRORS = (sqlite3.Error, OverflowError, UnicodeDecodeError, MemoryError)


class SqliteFile:
    """A bag file of sqlite3; see `StorageFile`.

    It is never written to: where a journal lies beside it, both are copied, and sqlite puts them together there.

    Raises
    ------
    BagError
        It cannot be opened, or is no bag.

    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.finished = False
        self.metadata: str | None = None
        self.storage = 'sqlite3'
        self.defects: list[str] = []
        self.cut_off: str | None = None
        self._opened: sqlite3.Connection | None = None
        try:
            self._place = self._put_together()
            tables = {name for (name,) in self._base.execute("SELECT name FROM sqlite_master WHERE type='table'")}
            if not {'topics', 'messages'} <= tables:
                raise BagError(f'{path} is no bag: it lacks the tables of one')
            self._topics = {
                each: (str(name).removeprefix('/'), str(kind))
                for each, name, kind in self._base.execute('SELECT id, name, type FROM topics')
            }
            if 'metadata' in tables:
                self._read_metadata()
        except OSError as error:
            raise BagError(f'{path} cannot be read: {error.strerror}') from error
        except _ERRORS as error:
            raise BagError(f'{path} is damaged: {_first_line(error)}') from error

    def close(self) -> None:
        """Leave the file; whoever reads again opens it again."""
        if self._opened is not None:
            self._opened.close()
            self._opened = None

    def scan(self) -> Iterator[StoredMessage]:
        """Yield all messages that can be read, in the order of recording."""
        last: Any = None
        try:
            for row in self._base.execute('SELECT id, topic_id, timestamp, data FROM messages ORDER BY id'):
                last = row[0]
                yield from self._message(*row)
        except _ERRORS as error:
            beyond = []
            try:
                backwards = self._base.execute('SELECT id, topic_id, timestamp, data FROM messages ORDER BY id DESC')
                for row in backwards:
                    if last is not None and row[0] <= last:
                        break
                    beyond.append(row[0])
            except _ERRORS:
                pass  # that is where the damage ends
            after = 'its beginning' if last is None else f'message {last}'
            self.defects.append(f'{self.path.name}: damaged after {after} ({_first_line(error)})')
            for number in reversed(beyond):
                yield from self._message(*self._row(number))

    def scan_tables(self) -> Iterator[StoredMessage | StoredTable]:
        """Yield the same: rows do not lie side by side."""
        return self.scan()

    def read(self, block: int, at: int) -> bytes:  # noqa: ARG002 - rows lie in one block
        """Return the data of a message at its place."""
        data = self._row(at)[3]
        if not isinstance(data, bytes):
            raise BagError(f'{self.path} is damaged: message {at} is gone')
        return unpack_message(data)

    def _row(self, number: int) -> Any:
        query = 'SELECT id, topic_id, timestamp, data FROM messages WHERE id=?'
        try:
            with closing(self._base.execute(query, (number,))) as found:
                return found.fetchone() or (number, None, None, None)
        except _ERRORS as error:
            raise BagError(f'{self.path} is damaged: {_first_line(error)}') from error

    def _message(self, number: Any, topic_id: Any, stamp: Any, data: Any) -> Iterator[StoredMessage]:
        known = self._topics.get(topic_id)
        numbers = isinstance(number, int) and isinstance(stamp, int)
        if known is None or not isinstance(data, bytes) or not numbers:
            self.defects.append(f'{self.path.name}: message {number} is damaged and left out')
            return
        try:
            yield StoredMessage(*known, stamp, 0, number, unpack_message(data))
        except DecompressionError as error:
            self.defects.append(f'{self.path.name}: message {number} is damaged and left out: {error}')

    def _read_metadata(self) -> None:
        rows = self._base.execute('SELECT metadata FROM metadata ORDER BY id').fetchall()
        if rows and isinstance(rows[-1][0], str):
            self.metadata = rows[-1][0]
            self.finished = True

    def _put_together(self) -> Path:
        """Return where the file is: with a journal beside it, where a copy of both is."""
        journals = [Path(f'{self.path}{suffix}') for suffix in JOURNALS]
        if not any(path.is_file() and path.stat().st_size for path in journals):
            return self.path
        folder = Path(tempfile.mkdtemp())
        weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        for path in (self.path, *filter(Path.is_file, journals)):
            shutil.copyfile(path, folder / path.name)
        return folder / self.path.name

    @property
    def _base(self) -> sqlite3.Connection:
        if self._opened is None:
            mode = 'mode=ro&immutable=1' if self._place == self.path else 'mode=rw'
            address = f'file:{quote(str(self._place.absolute()))}?{mode}'
            self._opened = sqlite3.connect(address, uri=True, check_same_thread=False)
            self._opened.text_factory = lambda raw: raw.decode(errors='replace')
            self._opened.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST)
            # A fault on a page in the middle must not be taken for the end of the file.
            self._opened.execute('PRAGMA cell_size_check=ON')
        return self._opened


def _first_line(error: BaseException) -> str:
    return (str(error) or type(error).__name__).splitlines()[0]
