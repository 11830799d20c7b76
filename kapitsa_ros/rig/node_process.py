"""One node as a process of its own."""

from __future__ import annotations

import os
import re
import signal
import threading
from collections import deque
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import yaml

from kapitsa_ros.rig.file_in_memory import file_in_memory

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kapitsa_ros.rig.fork_server_process import ForkServerProcess

LAST_LINES = 20
_OTHER = 'second writer'
_REFUSED = re.compile(r': (refused: .+ \(\d+ so far\))$')
_JOINED, _WAITING = re.compile(r': joins domain \d+$'), re.compile(r': waiting for (.+) in domain \d+')
_FOUND = re.compile(r': waits for nobody any more$')
"""Lines of a node: that it is there, for whom it waits; above, that it has not used what somebody said."""


class NodeProcess:
    """One node as a process of its own.

    Parameters
    ----------
    server
        What it is forked from.
    role
        Executable and name of the node.
    parameters
        ROS parameters; those the node does not declare are ignored by it.
    domain
        ROS domain.

    """

    def __init__(self, server: ForkServerProcess, role: str, parameters: Mapping[str, Any], domain: int) -> None:
        self.role = role
        self._lines: deque[str] = deque(maxlen=LAST_LINES)
        self._news = threading.Condition()
        self.has_joined = False
        """Whether it has said that it is in its domain."""
        self.waits_for: str | None = None
        """For whom it waits, as it last said."""
        self.refused: str | None = None
        """What it has last refused, of another writer if it had to do with one, and how often it did."""
        with ExitStack() as failed_start:
            pipe, stderr = os.pipe()
            self._stderr = failed_start.enter_context(open(pipe, encoding='utf-8', errors='replace'))  # noqa: PTH123
            of_any_node = {'/**': {'ros__parameters': dict(parameters)}}
            try:
                with file_in_memory(yaml.safe_dump(of_any_node, allow_unicode=True)) as file:
                    self._process = server.start(role, file.fileno(), stderr, domain)
            finally:
                os.close(stderr)
            failed_start.callback(self._process.close)
            failed_start.callback(self._process.send_signal, signal.SIGKILL)
            self._reader = threading.Thread(target=self._read, daemon=True)
            self._reader.start()
            failed_start.pop_all()

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    @property
    def sentinel(self) -> int:
        """A file descriptor that can be read once the process has ended."""
        return self._process.sentinel

    @property
    def orphaned(self) -> bool:
        """Whether the process that it was forked from was killed: it is about to leave."""
        return self._process.orphaned

    def status(self) -> int | None:
        """Return the exit status, that of a signal negative; None while it runs, or where it is an orphan."""
        return self._process.status()

    def _note_refused(self, text: str) -> None:
        if self.refused is None or _OTHER in text or _OTHER not in self.refused:
            self.refused = text

    def last_error_lines(self) -> str:
        """Return its last error, or else its last lines on stderr."""
        self._reader.join(timeout=1.0)
        lines = [line for line in self._lines if line.strip()]
        errors = [line for line in lines if line.startswith(f'{self.role}: error: ')]
        complaints = [line for line in lines if not line.startswith('[INFO]')]
        return errors[-1].removeprefix(f'{self.role}: error: ') if errors else '; '.join(complaints[-3:])

    def wait_for_line(self, text: str, timeout: float) -> bool:
        """Wait for a line on stderr that contains a text; return False if none comes in time."""
        with self._news:
            return self._news.wait_for(lambda: any(text in line for line in self._lines), timeout)

    def end(self, number: signal.Signals) -> None:
        """Send a signal, if it still runs."""
        self._process.send_signal(number)

    def close(self) -> None:
        """Wait for the end and free its descriptors."""
        self._process.close()
        self._reader.join(timeout=1.0)
        self._stderr.close()

    def _read(self) -> None:
        try:
            for line in self._stderr:
                with self._news:
                    self._lines.append(line.rstrip())
                    self.has_joined = self.has_joined or bool(_JOINED.search(line.rstrip()))
                    if refused := _REFUSED.search(line.rstrip()):
                        self._note_refused(refused[1])
                    if waiting := _WAITING.search(line):
                        self.waits_for = waiting[1]
                    elif _FOUND.search(line.rstrip()):
                        self.waits_for = None
                    self._news.notify_all()
        except ValueError:
            pass  # closed from the other side while stopping
