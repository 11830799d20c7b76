"""A word on stderr, where it is a terminal, while kernels are compiled: once after an installation."""

from __future__ import annotations

import sys
import time
from functools import cache
from typing import TYPE_CHECKING

from numba.core import event

if TYPE_CHECKING:
    from numba.core.event import Event


class _Announcer(event.Listener):  # type: ignore[misc]
    """Kernels are compiled into one another: only the outermost is named."""

    def __init__(self) -> None:
        self._depth, self._begin = 0, 0.0

    def on_start(self, event: Event) -> None:
        if not self._depth and sys.stderr.isatty():
            name = event.data['dispatcher'].py_func.__name__
            sys.stderr.write(f'kapitsa: compiling {name}, once after an installation\n')
        self._begin = self._begin if self._depth else time.monotonic()
        self._depth += 1

    def on_end(self, event: Event) -> None:  # noqa: ARG002
        self._depth -= 1
        if not self._depth and sys.stderr.isatty():
            sys.stderr.write(f'kapitsa: compiled in {time.monotonic() - self._begin:.1f} s\n')


@cache
def announce_compilation() -> None:
    """Say so from now on; compiled code that is loaded from disk is not worth a word."""
    event.register('numba:compile', _Announcer())
