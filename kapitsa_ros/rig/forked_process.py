"""A process that the fork server has made: somebody else's child, with the same questions to it as to one's own."""

from __future__ import annotations

import math
import os
import select
import signal
import socket
from contextlib import suppress

_LONGEST = 32
"""Bytes of a datagram from the server: a number, or two."""


class ForkedProcess:
    """A process that the fork server has made.

    Parameters
    ----------
    report
        The socket on which the server tells the process id, with a file descriptor of the process, and at last its
        exit status, and when it noticed the end. It is closed with this object.

    Raises
    ------
    EOFError
        The server could not make it.
    OSError
        This process has no file descriptor left.

    """

    def __init__(self, report: socket.socket) -> None:
        self._report = report
        self._status: int | None = None
        self.orphaned = False
        """Whether its server was killed: it is about to leave, and nobody can tell with which status."""
        self.ended_at = math.inf
        """When its server noticed its end, on the monotonic clock; infinite while nothing is known of that."""
        text, descriptors, _, _ = socket.recv_fds(report, _LONGEST, 1)
        if not text:
            raise EOFError
        self.pid = int(text)
        """Process id."""
        if not descriptors:
            os.kill(self.pid, signal.SIGKILL)
            report.recv(_LONGEST)
            raise OSError(f'no file descriptor is left for process {self.pid}')
        [self._pidfd] = descriptors

    @property
    def sentinel(self) -> int:
        """A file descriptor that can be read once the process has ended."""
        return self._report.fileno()

    def status(self) -> int | None:
        """Return the exit status, that of a signal negative; None while it runs, or where it is an orphan."""
        if _can_be_read(self._report.fileno(), 0):
            self._hear_end()
        return self._status

    def send_signal(self, number: signal.Signals) -> None:
        """Send a signal, if it still runs."""
        with suppress(ProcessLookupError):
            signal.pidfd_send_signal(self._pidfd, number)

    def close(self) -> None:
        """Wait for the end and free the descriptors."""
        _can_be_read(self._pidfd, None)
        self._hear_end()
        os.close(self._pidfd)
        self._report.close()

    def _hear_end(self) -> None:
        if self._status is None and not self.orphaned:
            text = self._report.recv(_LONGEST)
            self.orphaned = not text
            if text:
                status, when = text.split()
                self._status, self.ended_at = int(status), float(when)


def _can_be_read(descriptor: int, timeout_ms: int | None) -> bool:
    poll = select.poll()  # `select.select` takes no descriptor above 1023
    poll.register(descriptor, select.POLLIN)
    return bool(poll.poll(timeout_ms))
