"""SIGINT, SIGTERM and a closed terminal end a node in order, at whatever moment of its life they come."""

from __future__ import annotations

import os
import signal
import threading

_RCLPY_HEEDS = (signal.SIGINT, signal.SIGTERM)
_HEEDED = (*_RCLPY_HEEDS, signal.SIGHUP)


def leave_on_signals() -> None:
    """Leave at once, while nothing is open yet."""
    for number in _HEEDED:
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup sets SIGHUP
            signal.signal(number, lambda *_: os._exit(0))


def hold_signals_back() -> None:
    """Let signals wait, as while rclpy begins to listen and once it no longer does."""
    signal.pthread_sigmask(signal.SIG_BLOCK, _HEEDED)
    # rclpy passes a signal on to the handler it found, and puts it back when it is done: from now on that does nothing,
    # neither in the middle of the shutdown nor, where a signal comes twice, on the way out.
    for number in _RCLPY_HEEDS:
        signal.signal(number, lambda *_: None)


def let_signals_through() -> None:
    """Leave them to rclpy, which is initialised and shuts its context."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _RCLPY_HEEDS)
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
        # rclpy does not know SIGHUP, and Python sees no signal while it waits in rclpy.
        threading.Thread(target=_terminate_on_hangup, daemon=True).start()


def _terminate_on_hangup() -> None:
    signal.sigwait((signal.SIGHUP,))
    os.kill(os.getpid(), signal.SIGTERM)
