"""A file in memory, which is gone with its last reader."""

from __future__ import annotations

import os
from typing import TextIO


def file_in_memory(text: str) -> TextIO:
    """Return a file with a text, to be read from its begin, by this process or by one that gets its descriptor."""
    file = open(os.memfd_create('kapitsa_ros'), 'w+', encoding='utf-8')  # noqa: PTH123, SIM115  # the caller's
    file.write(text)
    file.seek(0)
    return file
