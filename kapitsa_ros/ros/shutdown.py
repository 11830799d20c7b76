"""Shutdown of a participant, which may hang or abort in DDS: a watchdog, and a wait for discovery to come to rest.

A participant that is taken down waits for discovery callbacks under way, with a deadline that overflows where libstdc++
has to convert it (Fast DDS 2.14, DomainParticipantImpl::set_listener). Meeting one it spins for ever, and holds a lock
that the callback needs, and Python's. They meet when many leave at once, as at the end of a session.
"""

from __future__ import annotations

import ctypes
import os
import signal
import time
from contextlib import suppress
from pathlib import Path

_CLOCK_MONOTONIC = 1
_SIGEV_THREAD = 2
_LOOK_PERIOD = 0.02
"""Seconds between two looks at threads that are to be quiet."""


class _Event(ctypes.Structure):
    """`struct sigevent` of glibc."""

    _fields_ = (
        ('value', ctypes.c_long),
        ('signal', ctypes.c_int),
        ('notify', ctypes.c_int),
        ('function', ctypes.c_void_p),
        ('attributes', ctypes.c_void_p),
        ('rest', ctypes.c_char * 32),
    )


class _Alarm(ctypes.Structure):
    """`struct itimerspec`."""

    _fields_ = tuple((name, ctypes.c_long) for name in ('every_s', 'every_ns', 'after_s', 'after_ns'))


_Handler = ctypes.CFUNCTYPE(None, ctypes.c_int)


class ShutdownWatchdog:
    """Ends this process when some time has gone by, even if it hangs in C with Python's lock held, or when C aborts.

    Parameters
    ----------
    seconds
        Of wall time.
    status
        Exit status.

    Raises
    ------
    OSError
        The system has no timer left.

    """

    def __init__(self, seconds: float, status: int) -> None:
        self._libc = ctypes.CDLL(None, use_errno=True)
        function = ctypes.cast(self._libc._exit, ctypes.c_void_p)  # noqa: SLF001  # its name in C
        event = _Event(value=status, notify=_SIGEV_THREAD, function=function)
        self._timer = ctypes.c_void_p()
        alarm = _Alarm(after_s=int(seconds), after_ns=int(seconds % 1 * 1e9))
        if self._libc.timer_create(
            _CLOCK_MONOTONIC, ctypes.byref(event), ctypes.byref(self._timer)
        ) or self._libc.timer_settime(self._timer, 0, ctypes.byref(alarm), None):
            raise OSError(ctypes.get_errno(), 'no timer')
        # Where the thread that aborts waits for Python's lock in vain, the timer ends it.
        self._abort = _Handler(lambda _: os._exit(status))
        self._libc.signal.restype = ctypes.c_void_p
        self._handler_before = ctypes.c_void_p(self._libc.signal(signal.SIGABRT, self._abort))

    def disarm(self) -> None:
        """Let the process live on: what could have hung has come back."""
        self._libc.timer_delete(self._timer)
        self._libc.signal(signal.SIGABRT, self._handler_before)


def wait_until_quiet(domain: int, patience: float) -> None:
    """Wait until the threads that hear a domain for this process have all come to rest, or for so many seconds."""
    deadline = time.monotonic() + patience
    before: dict[str, str] | None = None
    while time.monotonic() < deadline:
        now = listeners(domain)
        if now == before and all('State:\tS' in status for status in now.values()):
            return
        before = now
        time.sleep(_LOOK_PERIOD)


def listeners(domain: int) -> dict[str, str]:
    """Return /proc's status of each receive thread of Fast DDS for a domain; it counts how often the thread has run."""
    ports = range(7400 + 250 * domain, 7400 + 250 * (domain + 1))  # RTPS specification, 9.6.1.1
    found = {}
    for thread in Path('/proc/self/task').iterdir():
        with suppress(OSError):  # gone since
            port = (thread / 'comm').read_text(encoding='utf-8').strip().rpartition('dds.udp.')[2]
            if port.isdecimal() and int(port) in ports:
                found[thread.name] = (thread / 'status').read_text(encoding='utf-8')
    return found
