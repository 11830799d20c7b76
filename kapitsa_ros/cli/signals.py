"""SIGTERM and a closed terminal interrupt a command as Ctrl-C does: what it has begun is stopped in order."""

from __future__ import annotations

import os
import signal
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import FrameType


class Interrupt(BaseException):  # as KeyboardInterrupt is, but click does not know it
    """A signal came; the status is the one a shell gives to a command that it ended."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.status = 128 + number


def interrupt_on_signals() -> None:
    """Raise `Interrupt` where Python would raise KeyboardInterrupt, or end at once."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup sets SIGHUP
            signal.signal(number, _interrupt)


def _interrupt(number: int, frame: FrameType | None) -> None:  # noqa: ARG001
    if number == signal.SIGHUP:
        # Nobody listens any more, and a complaint about that would cut the stopping short.
        for stream in (sys.stdout, sys.stderr):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    raise Interrupt(number)
