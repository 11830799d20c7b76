"""SIGTERM and a closed terminal interrupt a command as Ctrl-C does: what it has begun is stopped in order."""

from __future__ import annotations

import os
import signal
import sys
import weakref
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import FrameType

_LOOK_PERIOD = 0.1
"""Seconds between two looks at whether an interrupt is still on its way to whoever stops the command."""


class Interrupt(BaseException):  # as KeyboardInterrupt is, but click does not know it
    """A signal came; the status is the one a shell gives to a command that it ended."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.status = 128 + number


_newest: weakref.ref[Interrupt] | None = None
_number = 0
"""Of the signal that came last."""


def interrupt_on_signals() -> None:
    """Raise `Interrupt` where Python would raise KeyboardInterrupt, or end at once.

    It is raised again if it gets lost: what is raised in a callback from C, as numba and llvmlite have them, or in a
    destructor, goes no farther, and some libraries catch everything while they are imported.
    """
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup sets SIGHUP
            signal.signal(number, _interrupt)
    signal.signal(signal.SIGALRM, _raise_lost)
    sys.unraisablehook = _show_unless_interrupt


def forget_interrupts() -> None:
    """Raise none again: the command is being ended."""
    signal.setitimer(signal.ITIMER_REAL, 0)


def _interrupt(number: int, frame: FrameType | None) -> None:  # noqa: ARG001
    global _number  # noqa: PLW0603  # as the signals are of the process
    if number == signal.SIGHUP:
        # Nobody listens any more, and a complaint about that would cut the stopping short.
        for stream in (sys.stdout, sys.stderr):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    _number = number
    signal.setitimer(signal.ITIMER_REAL, _LOOK_PERIOD, _LOOK_PERIOD)
    raise _noted(Interrupt(number))


def _raise_lost(number: int, frame: FrameType | None) -> None:  # noqa: ARG001
    """Look after the newest interrupt: while it is on its way, somebody holds it."""
    if _newest is None or _newest() is None:
        raise _noted(Interrupt(_number))


def _noted(interrupt: Interrupt) -> Interrupt:
    """Not in the frame that raises: with its traceback an exception would hold itself."""
    global _newest  # noqa: PLW0603  # as the signals are of the process
    _newest = weakref.ref(interrupt)
    return interrupt


def _show_unless_interrupt(unraisable: sys.UnraisableHookArgs) -> None:
    if not isinstance(unraisable.exc_value, Interrupt):
        sys.__unraisablehook__(unraisable)
