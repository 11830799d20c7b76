"""Nodes as processes: started together, watched, and stopped whatever happens."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import threading
import time
from collections import deque
from typing import TYPE_CHECKING, Any, Self

from kapitsa_ros.rig.environment import node_environment
from kapitsa_ros.rig.errors import RigError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import TracebackType

GRACE = 2.0
"""Seconds between asking a node to end and ending it."""
HASTE = 1.2
"""The same after something went wrong: whoever waits for the rig wants to be told."""
LAST_LINES = 20


class NodeProcess:
    """One node as a process of its own.

    Parameters
    ----------
    role
        Executable and name of the node.
    parameters
        ROS parameters; those the node does not declare are ignored by it.
    domain
        ROS domain.

    """

    def __init__(self, role: str, parameters: Mapping[str, Any], domain: int) -> None:
        self.role = role
        self._lines: deque[str] = deque(maxlen=LAST_LINES)
        self._news = threading.Condition()
        command = [sys.executable, '-m', 'kapitsa_ros.nodes', role, '--ros-args', '--disable-external-lib-logs']
        for name, value in parameters.items():
            command += ['-p', f'{name}:={_yaml(value)}']
        # A session of its own: Ctrl-C reaches the rig, which then ends its nodes in order.
        self._process = subprocess.Popen(  # noqa: S603
            command,
            env=node_environment(domain),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            errors='replace',
            start_new_session=True,
        )
        self.pidfd = os.pidfd_open(self._process.pid)
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    def status(self) -> int | None:
        """Return the exit status, or None while it runs."""
        return self._process.poll()

    def last_words(self) -> str:
        """Return what it said last; an error of its own if there was one."""
        self._reader.join(timeout=1.0)
        lines = [line for line in self._lines if line.strip()]
        errors = [line for line in lines if line.startswith(f'{self.role}: error: ')]
        complaints = [line for line in lines if not line.startswith('[INFO]')]
        return errors[-1].removeprefix(f'{self.role}: error: ') if errors else '; '.join(complaints[-3:])

    def wait_for_line(self, text: str, timeout: float) -> bool:
        """Wait until it says a line with a text in it; return False if it does not in time."""
        with self._news:
            return self._news.wait_for(lambda: any(text in line for line in self._lines), timeout)

    def end(self, number: signal.Signals) -> None:
        """Send a signal, if it still runs."""
        if self.status() is None:
            self._process.send_signal(number)

    def close(self) -> None:
        """Wait for the end and let go of what the system keeps for it."""
        self._process.wait()
        self._reader.join(timeout=1.0)
        if self._process.stderr is not None:
            self._process.stderr.close()
        os.close(self.pidfd)

    def _read(self) -> None:
        assert self._process.stderr is not None  # noqa: S101
        try:
            for line in self._process.stderr:
                with self._news:
                    self._lines.append(line.rstrip())
                    self._news.notify_all()
        except ValueError:
            pass  # closed from the other side while stopping


class Nodes:
    """The processes of a rig. A context: on leaving it, none is left."""

    def __init__(self, roles: Sequence[str], parameters: Mapping[str, Any], domain: int) -> None:
        self._processes: list[NodeProcess] = []
        self._left: dict[str, float] = {}
        try:
            for role in roles:
                self._processes.append(NodeProcess(role, parameters, domain))
        except BaseException:
            self.stop(HASTE)
            raise

    def __enter__(self) -> Self:
        """Start is over already."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop all."""
        self.stop(GRACE if kind is None else HASTE)

    def __getitem__(self, role: str) -> NodeProcess:
        """Return the process of a role."""
        return next(process for process in self._processes if process.role == role)

    def check(self) -> bool:
        """Return whether all have ended as they should; False while one runs.

        Raises
        ------
        RigError
            A node died; the message names it and its last words.

        """
        ended = [(process, process.status()) for process in self._processes]
        failed = [(process, status) for process, status in ended if status]
        # A node that broke is more telling than one that was killed, and than those that fell with it.
        for process, status in sorted(failed, key=lambda pair: pair[1] < 0):
            how = f'was killed by {signal.Signals(-status).name}' if status < 0 else f'died with status {status}'
            words = process.last_words()
            raise RigError(f'{process.role} {how}{": " + words if words else ""}')
        return all(status == 0 for _, status in ended)

    def refuse_leavers(self, patience: float) -> None:
        """Refuse that a node ended of itself, as after a signal, while others still need it.

        Raises
        ------
        RigError
            One did, longer ago than `patience` seconds.

        """
        now = time.monotonic()
        for process in self._processes:
            if process.status() == 0 and now - self._left.setdefault(process.role, now) > patience:
                raise RigError(f'{process.role} was ended before the session was over')

    def wait(self, timeout: float, *news: int) -> bool:
        """Wait until a node ends, a file descriptor of `news` can be read, or the time is over; then check.

        Raises
        ------
        RigError
            A node died.

        """
        running = [process.pidfd for process in self._processes if process.status() is None]
        if running:
            select.select([*running, *news], [], [], timeout)
        return self.check()

    def stop(self, grace: float) -> None:
        """End every node: asked first, then made to."""
        for number in (signal.SIGCONT, signal.SIGINT):
            for process in self._processes:
                process.end(number)
        deadline = time.monotonic() + grace
        for process in self._processes:
            select.select([process.pidfd], [], [], max(0.0, deadline - time.monotonic()))
            process.end(signal.SIGKILL)
        for process in self._processes:
            process.close()
        self._processes.clear()


def _yaml(value: Any) -> str:
    """Write a parameter as ROS reads it: as YAML, on one line."""
    if isinstance(value, list):
        return f'[{", ".join(map(_yaml, value))}]'
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'"
    return str(value).lower() if isinstance(value, bool) else repr(value)
