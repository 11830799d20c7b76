"""SIGINT, SIGTERM and SIGHUP end a node in order, whenever they come: blocked, deferred or handed to rclpy."""

from __future__ import annotations

import os
import signal
import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_RCLPY_SIGNALS = (signal.SIGINT, signal.SIGTERM)
SIGNALS = (*_RCLPY_SIGNALS, signal.SIGHUP)
_pending: set[int] = set()


@contextmanager
def restoring_signals() -> Iterator[None]:
    """Give the signals back to the program, as they were, when the context is left."""
    handlers = {number: signal.getsignal(number) for number in SIGNALS}
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    try:
        yield
    finally:
        _pending.clear()
        for number, handler in handlers.items():
            signal.signal(number, handler)
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def leave_on_signals() -> None:
    """Exit at once with status 0 on a signal; for the time before anything is open."""
    for number in SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup sets SIGHUP
            signal.signal(number, lambda *_: os._exit(0))


def hold_signals_back() -> None:
    """Block signals: while rclpy installs its handlers, and once it has removed them."""
    signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    # The threads of libraries do not wait: what reaches one of them is kept. rclpy passes a signal on to the handler it
    # found, and puts it back when it is done: to keep it does no harm, neither in the middle of the shutdown nor, where
    # a signal comes twice, on the way out.
    for number in _RCLPY_SIGNALS:
        signal.signal(number, lambda number, _: _pending.add(number))


def ignore_signals() -> None:
    """Ignore signals until the process has ended; Python would restore handlers that end it with another status."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def let_signals_through() -> None:
    """Unblock signals, deliver the deferred ones, and leave them to rclpy, which shuts its context."""
    from rclpy.signals import SignalHandlerOptions, install_signal_handlers  # noqa: PLC0415  # slow

    # Not by rclpy.init: what reaches a thread of a library, which does not wait, would shut the context at any moment.
    install_signal_handlers(SignalHandlerOptions.ALL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _RCLPY_SIGNALS)  # calls Python's handlers of what has come before
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
        signal.signal(signal.SIGHUP, lambda *_: signal.raise_signal(signal.SIGTERM))
        # rclpy does not know SIGHUP, and Python sees no signal while it waits in rclpy.
        threading.Thread(target=_terminate_on_hangup, daemon=True).start()
    for number in tuple(_pending):
        signal.raise_signal(number)


def _terminate_on_hangup() -> None:
    signal.sigwait((signal.SIGHUP,))
    os.kill(os.getpid(), signal.SIGTERM)
