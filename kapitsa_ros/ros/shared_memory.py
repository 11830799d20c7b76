"""Whether /dev/shm has room for what LTTng, which rclpy loads, maps there: without it a signal kills the process."""

from __future__ import annotations

import os
from pathlib import Path

from kapitsa_ros.ros.errors import NodeError

_FOLDER = Path('/dev/shm')  # noqa: S108  # where LTTng waits for a tracer
_PAGES = 2
"""One of all users, one of this user."""


def refuse_full_shared_memory(folder: Path = _FOLDER) -> None:
    """Look whether there is room, or the pages are there already.

    Raises
    ------
    NodeError
        To import rclpy would end the process with SIGBUS.

    """
    try:
        free = os.statvfs(folder).f_bavail
        pages = [file for file in folder.glob('lttng-ust-wait-*') if file.stat().st_blocks]
    except OSError:  # it is not there, or not ours to look at: then LTTng does without
        return
    if free + len(pages) < _PAGES:
        raise NodeError(f'{folder} is full, and a node is killed there: free some of it, or mount a larger one')
