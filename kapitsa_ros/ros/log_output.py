"""The variables of the environment by which rcl's log lines look another way, or go elsewhere."""

from __future__ import annotations

import os

from kapitsa_ros.errors import shorten
from kapitsa_ros.ros.errors import SettingError

FORMAT = 'RCUTILS_CONSOLE_OUTPUT_FORMAT'
SWITCHES = ('RCUTILS_COLORIZED_OUTPUT', 'RCUTILS_LOGGING_USE_STDOUT', 'RCUTILS_LOGGING_BUFFERED_STREAM')


def refuse_unknown_switches() -> None:
    """Look at the switches, of which rcl knows two positions.

    Raises
    ------
    SettingError
        No node could be made.

    """
    for name in SWITCHES:
        if (value := os.environ.get(name, '')) not in {'', '0', '1'}:
            raise SettingError(f'{name} is {shorten(value)}: give 0 or 1')
