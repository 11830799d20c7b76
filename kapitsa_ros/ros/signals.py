"""SIGINT, SIGTERM and a closed terminal end a node in order, at whatever moment of its life they come."""

from __future__ import annotations

import os
import signal
import threading

_RCLPY_HEEDS = (signal.SIGINT, signal.SIGTERM)
_HEEDED = (*_RCLPY_HEEDS, signal.SIGHUP)
_kept: set[int] = set()


def leave_on_signals() -> None:
    """Leave at once, while nothing is open yet."""
    for number in _HEEDED:
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup sets SIGHUP
            signal.signal(number, lambda *_: os._exit(0))


def hold_signals_back() -> None:
    """Let signals wait, as while rclpy begins to listen and once it no longer does."""
    signal.pthread_sigmask(signal.SIG_BLOCK, _HEEDED)
    # The threads of libraries do not wait: what reaches one of them is kept. rclpy passes a signal on to the handler it
    # found, and puts it back when it is done: to keep it does no harm, neither in the middle of the shutdown nor, where
    # a signal comes twice, on the way out.
    for number in _RCLPY_HEEDS:
        signal.signal(number, lambda number, _: _kept.add(number))


def ignore_signals() -> None:
    """Let nothing disturb a process on its way out; Python would put back what ends it with another status."""
    for number in _HEEDED:
        signal.signal(number, signal.SIG_IGN)


def let_signals_through() -> None:
    """Leave them to rclpy, which is initialised and shuts its context."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _RCLPY_HEEDS)
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
        signal.signal(signal.SIGHUP, lambda *_: signal.raise_signal(signal.SIGTERM))
        # rclpy does not know SIGHUP, and Python sees no signal while it waits in rclpy.
        threading.Thread(target=_terminate_on_hangup, daemon=True).start()
    for number in tuple(_kept):
        signal.raise_signal(number)


def _terminate_on_hangup() -> None:
    signal.sigwait((signal.SIGHUP,))
    os.kill(os.getpid(), signal.SIGTERM)
