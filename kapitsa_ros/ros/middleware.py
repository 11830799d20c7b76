"""Whether the middleware that the environment names is there: to import rclpy without it ends the process."""

from __future__ import annotations

import ctypes
import os

from kapitsa_ros.ros.errors import SettingError

NAME = 'RMW_IMPLEMENTATION'


def refuse_missing_middleware() -> None:
    """Look for the library of the middleware before rclpy does.

    Raises
    ------
    SettingError
        It is not installed.

    """
    name = os.environ.get(NAME)
    if not name:
        return
    try:
        ctypes.CDLL(f'lib{name}.so')
    except OSError as error:
        raise SettingError(
            f'{NAME} is {name}, which cannot be loaded ({error}): '
            f'unset it, or install ros-jazzy-{name.replace("_", "-")}'
        ) from error
