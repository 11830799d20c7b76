"""The files of a bag: a folder with its metadata, a folder that never got any, or a storage file alone."""

from __future__ import annotations

import re
import shutil
import tempfile
import weakref
from pathlib import Path
from typing import TYPE_CHECKING

import zstandard

from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.storage import mcap_file, sqlite_file
from kapitsa_ros.recording.storage.decompression import ZSTD_MAGIC
from kapitsa_ros.recording.storage.promise import Promise, parse_promise

if TYPE_CHECKING:
    from kapitsa_ros.recording.storage.stored_message import StorageFile

METADATA = 'metadata.yaml'
"""What a recorder writes last."""
SUFFIXES = ('.mcap', '.db3', '.mcap.zstd', '.db3.zstd')
_LARGEST_METADATA = 2**24
_MOST_GROWTH, _SMALL = 200, 2**28
"""No motion packs better than so many times; what unpacks to so many bytes is taken all the same."""


class BagFiles:
    """The storage files of a bag, opened.

    Parameters
    ----------
    path
        A folder, or a storage file.

    Raises
    ------
    BagError
        There is no bag, or none of its files can be opened.

    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.defects: list[str] = []
        self.promise: Promise | None = None
        """What metadata.yaml says; None without one."""
        self.files: list[StorageFile] = []
        paths = self._paths()
        for each in paths:
            self._open(each, alone=len(paths) == 1)
        if not self.files:
            raise BagError(f'{path} cannot be read: {"; ".join(self.defects)}')

    def close(self) -> None:
        """Leave the files; whoever reads again opens them again."""
        for file in self.files:
            file.close()

    def _paths(self) -> list[Path]:
        try:
            if self.path.is_file():
                return [self.path]
            if not self.path.is_dir():
                raise BagError(f'{self.path} is no bag: give the folder of a run')
            there = storage_files(self.path)
            text = self._metadata()
            if text is None and not there:
                raise BagError(f'{self.path} is no bag: {_what_else(self.path)}')
        except OSError as error:
            raise BagError(f'{self.path} cannot be read: {error.strerror}') from error
        if text is not None:
            try:
                self.promise = parse_promise(text)
            except BagError as error:
                if not there:
                    raise BagError(f'{self.path} cannot be read: {METADATA}: {error}') from error
                self.defects.append(f'{METADATA} cannot be used: {error}')
        if self.promise is None:
            return there
        named = [self.path / name for name in self.promise.files]
        missing = [each.name for each in named if not each.is_file()]
        if missing:
            self.defects.append(f'{", ".join(missing)}, named in {METADATA}, is not there')
        # Somebody has renamed them; what is in them says what they are.
        return [each for each in named if each.is_file()] or there

    def _metadata(self) -> str | None:
        file = self.path / METADATA
        if not file.is_file():
            return None
        if file.stat().st_size > _LARGEST_METADATA:
            self.defects.append(f'{METADATA} is too large to be one')
            return ''
        return file.read_text(encoding='utf-8', errors='replace')

    def _open(self, path: Path, *, alone: bool) -> None:
        try:
            self.files.append(self._opened(path))
        except BagError as error:
            if alone:
                raise
            self.defects.append(f'{path.name} cannot be used: {error}')

    def _opened(self, path: Path) -> StorageFile:
        magic = _first_bytes(path)
        if magic.startswith(ZSTD_MAGIC):
            path = self._unpacked(path)
            magic = _first_bytes(path)
        if magic.startswith(mcap_file.MAGIC):
            return mcap_file.McapFile(path)
        if magic.startswith(sqlite_file.MAGIC):
            return sqlite_file.SqliteFile(path)
        kind = 'is empty' if not magic else 'is neither MCAP nor sqlite3'
        raise BagError(f'{path} cannot be read: it {kind}')

    def _unpacked(self, path: Path) -> Path:
        """Unpack a file that was compressed as a whole; what can be unpacked of it counts."""
        folder = Path(tempfile.mkdtemp())
        weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        unpacked = folder / path.name.removesuffix('.zstd')
        most = max(_SMALL, path.stat().st_size * _MOST_GROWTH)
        most = min(most, shutil.disk_usage(folder).free // 2)
        done = 0
        try:
            with path.open('rb') as packed, unpacked.open('wb') as out:
                for piece in zstandard.ZstdDecompressor().read_to_iter(packed):
                    done += len(piece)
                    if done > most:
                        raise BagError(f'{path} unpacks to more than {most} bytes, which no recording does')
                    out.write(piece)
        except zstandard.ZstdError as error:
            self.defects.append(f'{path.name}: damaged after {done} unpacked bytes ({error})')
        except OSError as error:
            raise BagError(f'{path} cannot be unpacked: {error.strerror}') from error
        return unpacked


def storage_files(folder: Path) -> list[Path]:
    """Return the storage files in a folder, in the order of their numbers.

    Raises
    ------
    OSError
        It cannot be looked into.

    """
    found = (path for path in folder.iterdir() if path.name.endswith(SUFFIXES) and path.is_file())
    return sorted(found, key=in_order)


def is_bag(path: Path) -> bool:
    """Whether a folder is a bag, or what is left of one.

    Raises
    ------
    OSError
        It cannot be looked into.

    """
    return path.is_dir() and ((path / METADATA).is_file() or bool(storage_files(path)))


def _what_else(folder: Path) -> str:
    """Say what a folder is that is no bag."""
    bags = sorted((each for each in folder.iterdir() if is_bag(each)), key=in_order)
    if not bags:
        return f'it has no {METADATA}'
    return f'it is a folder of {len(bags)}: give one of them, such as {bags[0]}'


def in_order(path: Path) -> list[tuple[int, str]]:
    """Sort names by the numbers in them, 9 before 10."""
    return [(int(part) if part.isdecimal() else -1, part) for part in re.split(r'(\d+)', path.name)]


def _first_bytes(path: Path) -> bytes:
    try:
        with path.open('rb') as file:
            return file.read(16)
    except OSError as error:
        raise BagError(f'{path} cannot be read: {error.strerror}') from error
