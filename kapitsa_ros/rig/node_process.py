"""One node as a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections import deque
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import yaml

from kapitsa_ros.rig.environment import node_environment
from kapitsa_ros.ros.arguments import PARENT_OPTION

if TYPE_CHECKING:
    import signal
    from collections.abc import Mapping

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
        file = _params_file(parameters)
        command = [sys.executable, '-m', 'kapitsa_ros.nodes', role, PARENT_OPTION, str(os.getpid())]
        command += ['--ros-args', '--disable-external-lib-logs', '--params-file', f'/proc/self/fd/{file}']
        # A session of its own: Ctrl-C reaches the rig, which then ends its nodes in order.
        try:
            self._process = subprocess.Popen(  # noqa: S603
                command,
                env=node_environment(domain),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
                errors='replace',
                start_new_session=True,
                pass_fds=(file,),
            )
        finally:
            os.close(file)
        with ExitStack() as failed_start:
            failed_start.push(self._process)
            failed_start.callback(self._process.kill)
            self.pidfd = os.pidfd_open(self._process.pid)
            failed_start.callback(os.close, self.pidfd)
            self._reader = threading.Thread(target=self._read, daemon=True)
            self._reader.start()
            failed_start.pop_all()

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    def status(self) -> int | None:
        """Return the exit status, or None while it runs."""
        return self._process.poll()

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
        if self.status() is None:
            self._process.send_signal(number)

    def close(self) -> None:
        """Wait for the end and free its descriptors."""
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


def _params_file(parameters: Mapping[str, Any]) -> int:
    """Write parameters for nodes of any name to a file in memory, which is gone with its last reader."""
    file = os.memfd_create('parameters')
    text = yaml.safe_dump({'/**': {'ros__parameters': dict(parameters)}}, allow_unicode=True)
    with os.fdopen(os.dup(file), 'w', encoding='utf-8') as writer:
        writer.write(text)
    return file
