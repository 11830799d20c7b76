"""A process of nodes: of one, or of several that are composed."""

from __future__ import annotations

import os
import re
import signal
import threading
from collections import deque
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from kapitsa_ros.rig.file_in_memory import file_in_memory
from kapitsa_ros.rig.parameters_yaml import parameters_yaml
from kapitsa_ros.ros.arguments import COMPOSED

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kapitsa_ros.rig.fork_server_process import ForkServerProcess

LAST_LINES = 20
"""Of a node."""
_OTHER = 'second writer'
_SAYS = r'(\w+)\]?: '
"""What stands before a node's line: its name, in brackets unless the user wants it otherwise."""
_REFUSED = re.compile(rf'{_SAYS}(refused: .+ \(\d+ so far\))$')
_HELD_UP = re.compile(rf'{_SAYS}(\S+ (?:is full|has not been taken): .+)$')
_JOINED, _WAITING = re.compile(rf'{_SAYS}joins domain \d+$'), re.compile(rf'{_SAYS}waiting for (.+) in domain \d+')
_FOUND = re.compile(rf'{_SAYS}waits for nobody any more$')
_RESET = re.compile(rf'{_SAYS}run (\d+) is reset before step \d+, by jigsaw/reset$')
"""Lines of a node: that it is there, for whom it waits, that it was reset; above, that it has refused something, or is
held up."""
_FAILED = re.compile(r'(\w+): error: (.*)')


class NodeProcess:
    """A process of nodes: of one, or of several that are composed.

    Parameters
    ----------
    server
        What it is forked from.
    roles
        Executables and names of the nodes.
    parameters
        ROS parameters; those a node does not declare are ignored by it.
    domain
        ROS domain.

    """

    def __init__(
        self, server: ForkServerProcess, roles: Sequence[str], parameters: Mapping[str, Any], domain: int
    ) -> None:
        self.roles = tuple(roles)
        self.name = roles[0] if len(roles) == 1 else f'the process of {", ".join(roles)}'
        """As messages name it."""
        self._lines: deque[str] = deque(maxlen=LAST_LINES * len(roles))
        self._news = threading.Condition()
        self._joined: set[str] = set()
        self.waits: dict[str, str] = {}
        """For whom each role waits, as it last said."""
        self._reset_runs: list[int] = []
        self.refused: dict[str, str] = {}
        """What each role has last refused, of another writer if it had to do with one, and how often it did."""
        self.held_up: dict[str, str] = {}
        """What of each role is not taken by a reader, as it last said."""
        with ExitStack() as failed_start:
            pipe, stderr = os.pipe()
            self._stderr = failed_start.enter_context(open(pipe, encoding='utf-8', errors='replace'))  # noqa: PTH123
            try:
                with file_in_memory(parameters_yaml(parameters)) as file:
                    nodes = self.roles if len(roles) == 1 else (COMPOSED, *roles)
                    self._process = server.start(nodes, file.fileno(), stderr, domain)
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

    @property
    def ended_at(self) -> float:
        """When its end was noticed, on the monotonic clock; infinite while nothing is known of that."""
        return self._process.ended_at

    def status(self) -> int | None:
        """Return the exit status, that of a signal negative; None while it runs, or where it is an orphan."""
        return self._process.status()

    @property
    def has_joined(self) -> bool:
        """Whether all its nodes have said that they are in their domain."""
        return self._joined >= set(self.roles)

    def last_error_lines(self) -> str:
        """Return its last error, or else its last lines on stderr."""
        return self.last_error()[1]

    def last_error(self) -> tuple[str, str]:
        """Return whose its last error was, and which; or else its own name and its last lines on stderr."""
        self._reader.join(timeout=1.0)
        lines = [line for line in self._lines if line.strip()]
        errors = [found for line in lines if (found := _FAILED.fullmatch(line)) and found[1] in self.roles]
        if errors:
            return errors[-1][1], errors[-1][2]
        return self.name, '; '.join([line for line in lines if not line.startswith('[INFO]')][-3:])

    def reset_runs(self) -> list[int]:
        """Return the numbers of the runs that were reset, as its node that owns time has said."""
        if self.status() is not None:
            self._reader.join(timeout=1.0)
        return list(self._reset_runs)

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
                    self._note(line.rstrip())
                    self._news.notify_all()
        except ValueError:
            pass  # closed from the other side while stopping

    def _note(self, line: str) -> None:
        if joined := _JOINED.search(line):
            self._joined.add(joined[1])
        elif reset := _RESET.search(line):
            self._reset_runs.append(int(reset[2]))
        elif refused := _REFUSED.search(line):
            role, text = refused.groups()
            if _OTHER in text or _OTHER not in self.refused.get(role, ''):
                self.refused[role] = text
        elif held_up := _HELD_UP.search(line):
            self.held_up[held_up[1]] = held_up[2]
        elif waiting := _WAITING.search(line):
            self.waits[waiting[1]] = waiting[2]
        elif found := _FOUND.search(line):
            self.waits.pop(found[1], None)
