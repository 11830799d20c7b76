"""Where machine code of kernels is kept, and when it is out of date, damaged or cannot be kept."""

from __future__ import annotations

import functools
import pickle
import sys
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numba.core.caching import FunctionCache, IndexDataCacheFile

from kapitsa_ros.numba_settings import numba_settings

if TYPE_CHECKING:
    from collections.abc import Callable

_CHECKSUM = 4
"""Bytes at the end of what is kept."""


def _stamp() -> tuple[object, ...]:
    """Return what tells one state of all kernels' sources from another, compiled by one set of rules or another."""
    files = sorted(Path(__file__).parent.glob('*.py'))
    return (*((file.name, file.stat().st_mtime_ns, file.stat().st_size) for file in files), *numba_settings())


_STAMP = _stamp()


class KernelCache(FunctionCache):  # type: ignore[misc]
    """Numba's cache of one function; what cannot be loaded of it is compiled again, and kept in its place.

    Parameters
    ----------
    function
        The kernel's source.

    Raises
    ------
    RuntimeError
        There is no folder that can be written.

    """

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        # Numba asks only whether the function's own file has changed, but kernels are compiled into one another, and
        # what was compiled by NUMBA_OPT=0 would be taken without it.
        self._cache_file = _CheckedFiles(self._cache_path, self._impl.filename_base, _STAMP)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return what is kept for a signature; None where there is nothing, or nothing that can be used."""
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # noqa: BLE001  # a damaged file raises whatever it happens to say to who reads it
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep what was compiled for a signature, unless the disk does not take it."""
        try:
            super().save_overload(sig, data)
        except OSError:
            warn_of_no_cache()


class _CheckedFiles(IndexDataCacheFile):  # type: ignore[misc]
    """Files of a cache; after a power cut one may have its length and not its content, and machine code is run."""

    def _dump(self, obj: Any) -> bytes:
        data: bytes = super()._dump(obj)
        return data + _checksum(data)

    def _load_index(self) -> dict[Any, str]:
        try:
            index: dict[Any, str] = super()._load_index()
        except Exception:  # noqa: BLE001  # as above; what is kept next begins a new one
            return {}
        return index

    def _load_data(self, name: str) -> Any:
        data = Path(self._data_path(name)).read_bytes()
        if _checksum(data[:-_CHECKSUM]) != data[-_CHECKSUM:]:
            raise pickle.UnpicklingError
        return pickle.loads(data)  # noqa: S301  # as Numba does; what follows its end is not read


def _checksum(data: bytes) -> bytes:
    return zlib.crc32(data).to_bytes(_CHECKSUM, 'little')


@functools.cache
def warn_of_no_cache() -> None:
    """Say it once a process."""
    sys.stderr.write(
        'kapitsa: warning: no folder for compiled kernels can be written, each process compiles them again: '
        'set NUMBA_CACHE_DIR to a folder you can write to\n'
    )
