"""Where ROS keeps the log files of nodes, and whether it can."""

from __future__ import annotations

import os
from pathlib import Path

from kapitsa_ros.ros.arguments import NO_LOG_FILES


def log_folder() -> Path | None:
    """Return the folder that rcl would take, or None where the environment names none."""
    if folder := os.environ.get('ROS_LOG_DIR'):
        return Path(folder)
    if folder := os.environ.get('ROS_HOME'):
        return Path(folder) / 'log'
    home = os.environ.get('HOME')
    return Path(home) / '.ros' / 'log' if home else None


def without_log_files() -> list[str]:
    """Return the ROS arguments of a node that has nowhere to log: rcl would refuse to start it."""
    folder = log_folder()
    try:
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
            if os.access(folder, os.W_OK | os.X_OK):
                return []
    except OSError:
        pass
    return NO_LOG_FILES
