"""Shared memory that killed nodes have left behind."""

from __future__ import annotations

import re
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_FOLDER = Path('/dev/shm')  # noqa: S108  # where Fast DDS keeps its segments
_SEGMENT = re.compile(r'fastrtps_(?:port\d+|[0-9a-f]{16})')
_COMPANIONS = ('{}', '{}_el', '{}_sl', 'sem.{}_mutex')


@contextmanager
def no_dead_segments() -> Iterator[None]:
    """Remove what earlier processes left, and on the way out what those of the context left."""
    remove_dead_segments()
    try:
        yield
    finally:
        remove_dead_segments()


def remove_dead_segments() -> None:
    """Remove the segments of Fast DDS that no process has mapped: a process that is killed cannot do it itself."""
    if not _FOLDER.is_dir():
        return
    left = {match[0] for path in _FOLDER.iterdir() if (match := _SEGMENT.search(path.name))}
    for name in left - _mapped() if left else ():
        for companion in _COMPANIONS:
            with suppress(OSError):  # somebody else's, or somebody was faster
                (_FOLDER / companion.format(name)).unlink()


def _mapped() -> set[str]:
    """Return the segments that a process of this machine has in its memory."""
    names: set[str] = set()
    for maps in Path('/proc').glob('[0-9]*/maps'):
        with suppress(OSError):
            names |= set(_SEGMENT.findall(maps.read_text()))
    return names
