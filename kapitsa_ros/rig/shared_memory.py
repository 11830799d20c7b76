"""Shared memory that killed nodes have left behind."""

from __future__ import annotations

import fcntl
import os
import re
import time
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Iterator

_FOLDER = Path('/dev/shm')  # noqa: S108  # where Fast DDS keeps its segments
_SEGMENT = re.compile(r'(fastrtps_[0-9a-f]{16})(?:_el)?')
"""What every participant makes; the ports beside them are of nodes without config/loopback.xml, and not of a rig."""
_LOCKS = Path('/proc/locks')
_LOCK = '_el'
"""Ending of the file that the owner of a segment holds locked while it lives."""
_LOCKED = re.compile(r'[0-9a-f]+:[0-9a-f]+:\d+')
"""Device and inode, as /proc/locks has them."""
_NEW = 1.0
"""Seconds after which the maker of a lock has taken it."""
_LOOK_PERIOD = 0.05
"""Seconds between two looks at locks that are new."""
State = Literal['owned', 'stale', 'new']


@contextmanager
def removing_stale_segments() -> Iterator[None]:
    """Remove what earlier processes left, and on the way out what those of the context left."""
    remove_stale_segments()
    try:
        yield
    finally:
        deadline = time.monotonic() + _NEW
        remove_stale_segments()
        # A node that was killed soon after its start has left what may be just about to get its owner.
        while segments_in_state('new') and time.monotonic() < deadline:
            time.sleep(_LOOK_PERIOD)
            remove_stale_segments()


def remove_stale_segments() -> None:
    """Remove the segments of Fast DDS that have no owner: a process that is killed cannot do it itself."""
    for name in stale_segments():
        for file in (name, f'{name}{_LOCK}'):
            with suppress(OSError):  # somebody else's, or somebody was faster
                (_FOLDER / file).unlink()


def stale_segments() -> set[str]:
    """Return the names of the segments that have no owner."""
    return segments_in_state('stale')


def segments_in_state(state: State) -> set[str]:
    """Return the names of the segments that have an owner, have lost him, or are so new that they may just get one."""
    if not _FOLDER.is_dir():
        return set()
    left = {match[1] for path in _FOLDER.iterdir() if (match := _SEGMENT.fullmatch(path.name))}
    # To try a lock takes it for a moment, in which its owner to be could not: so it is tried only where the list of
    # held ones, which may lack some while others come and go, does not name it.
    try:
        held = set(_LOCKED.findall(_LOCKS.read_text(encoding='ascii')))
    except OSError:  # as in some sandboxes: whose a segment is cannot be found out, and all are left
        return set()
    return {name for name in left if _state(_FOLDER / f'{name}{_LOCK}', held) == state}


def _state(lock: Path, held: set[str]) -> State:
    try:
        file = lock.stat()
        if f'{os.major(file.st_dev):02x}:{os.minor(file.st_dev):02x}:{file.st_ino}' in held:
            return 'owned'
        if time.time() - file.st_ctime < _NEW:
            return 'new'
        return 'owned' if _is_held(lock) else 'stale'
    except FileNotFoundError:
        return 'stale'
    except PermissionError:
        return 'owned'  # by somebody else


def _is_held(lock: Path) -> bool:
    with lock.open('rb') as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False
