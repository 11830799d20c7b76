"""Whether /dev/shm has room for what is mapped there when a node starts: without it a signal kills the process."""

from __future__ import annotations

import os
from pathlib import Path

from kapitsa_ros.ros.errors import NodeError

_FOLDER = Path('/dev/shm')  # noqa: S108  # where Fast DDS keeps its segments, and LTTng, which rclpy loads, a page
NEEDED = 8 * 2**20
"""Bytes: half a megabyte for each participant of a rig, and some more."""


def refuse_full_shared_memory(folder: Path = _FOLDER) -> None:
    """Look whether there is room. Where the folder is not there or cannot be written, nothing is mapped.

    Raises
    ------
    NodeError
        A node would be ended by SIGBUS, without a word.

    """
    try:
        system = os.statvfs(folder)
    except OSError:
        return
    free = system.f_bavail * system.f_frsize
    if free < NEEDED and os.access(folder, os.W_OK):
        raise NodeError(
            f'{folder} has {free / 2**20:.1f} MB left, and nodes that find no room there are killed: '
            f'free {NEEDED / 2**20:.0f} MB, or mount a larger one'
        )
