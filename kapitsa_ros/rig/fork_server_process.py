"""The process that nodes are forked from: one a program, for all its rigs, as long as there is one.

A program that has done nothing yet but load forks it from itself, as the command line does: what both need is loaded
once. Else it is a new process: a program may have opened DDS or started threads, neither of which survives a fork.
"""

from __future__ import annotations

import json
import multiprocessing
import socket
import subprocess
import sys
import threading
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Protocol

from kapitsa_ros.network.registry import KERNEL_NAMES
from kapitsa_ros.rig.environment import node_environment
from kapitsa_ros.rig.errors import RigError
from kapitsa_ros.rig.file_in_memory import file_in_memory
from kapitsa_ros.rig.fork_server import MODULE, forking, preload, preload_kernels, serve_forked
from kapitsa_ros.rig.forked_process import ForkedProcess

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


class _Process(Protocol):
    pid: int

    def poll(self) -> int | None: ...
    def wait(self) -> object: ...


class _Forked:
    """A process forked from this program, asked as one of `subprocess` is."""

    def __init__(self, requests: socket.socket) -> None:
        preload()
        preload_kernels(KERNEL_NAMES)  # the program and its analyser run some, too
        # A daemon: it may not outlive the program, whatever ends that.
        fork = multiprocessing.get_context('fork').Process(target=serve_forked, args=(requests,), daemon=True)
        with forking():
            fork.start()
        assert fork.pid is not None  # noqa: S101  # it was started
        self.pid = fork.pid
        self._fork = fork

    def poll(self) -> int | None:
        return self._fork.exitcode

    def wait(self) -> None:
        self._fork.join()


def _spawned(requests: socket.socket) -> _Process:
    return subprocess.Popen(  # noqa: S603
        [sys.executable, '-m', MODULE, str(requests.fileno())],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        start_new_session=True,
        pass_fds=(requests.fileno(),),
    )


class ForkServerProcess:
    """The process that nodes are forked from. It ends when it is closed, or with this program.

    Parameters
    ----------
    from_here
        Whether it is forked from this program, which has no other thread and nothing of DDS yet.

    """

    def __init__(self, *, from_here: bool = False) -> None:
        self._requests, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.users = 0
        """Contexts of `fork_server` under way."""
        with theirs:
            self._process: _Process = _Forked(theirs) if from_here else _spawned(theirs)

    @property
    def pid(self) -> int:
        """Process id: that of the parent of the nodes."""
        return self._process.pid

    def has_ended(self) -> bool:
        """Whether it was ended by somebody else, and its nodes with it."""
        return self._process.poll() is not None

    def start(self, nodes: Sequence[str], parameters: int, stderr: int, domain: int) -> ForkedProcess:
        """Start a process of nodes.

        Parameters
        ----------
        nodes
            A role; or `composed`, and several.
        parameters, stderr
            File descriptors of its parameters, and of the pipe it writes to.
        domain
            ROS domain.

        Raises
        ------
        OSError, RigError
            It cannot be started.

        """
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with ExitStack() as failed_start:
            failed_start.enter_context(ours)
            request = {'nodes': list(nodes), 'environment': node_environment(domain)}
            try:
                with theirs, file_in_memory(json.dumps(request)) as file:
                    files = [file.fileno(), parameters, stderr, theirs.fileno()]
                    socket.send_fds(self._requests, [' '.join(nodes).encode()], files)
                started = ForkedProcess(ours)
            except (BrokenPipeError, ConnectionResetError, EOFError):
                how = 'has ended' if self.has_ended() else 'has no process or file descriptor left'
                raise RigError(
                    f'{nodes[0]} cannot be started: what it is forked from, process {self.pid}, {how}'
                ) from None
            failed_start.pop_all()
        return started

    def close(self) -> None:
        """End it, and wait for its end."""
        self._requests.close()
        self._process.wait()


_lock = threading.Lock()
_shared: ForkServerProcess | None = None


@contextmanager
def fork_server(*, from_here: bool = False) -> Iterator[ForkServerProcess]:
    """Give the program's server, which lives as long as one of these contexts.

    Several rigs one after the other start faster in a context of their own around all of them.

    Parameters
    ----------
    from_here
        Whether it may be forked from this program, which has no other thread and nothing of DDS yet.

    """
    global _shared  # noqa: PLW0603  # there is one a program
    with _lock:
        if _shared is None or _shared.has_ended():
            _shared = ForkServerProcess(from_here=from_here)
        server = _shared
        server.users += 1
    try:
        yield server
    finally:
        with _lock:
            server.users -= 1
            if not server.users:
                server.close()
                if _shared is server:
                    _shared = None
