"""The process that nodes are forked from: one a program, for all its rigs, as long as there is one.

A program that has done nothing yet but load forks it from itself, as the command line does: what both need is loaded
once, or by the server while the program loads what it alone needs. Else it is a new process: a program may have opened
DDS or started threads, neither of which survives a fork.
"""

from __future__ import annotations

import json
import multiprocessing
import select
import socket
import subprocess
import threading
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Protocol

from kapitsa_ros.new_interpreter import run_by_new_interpreter
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
    def kill(self) -> None: ...


class _Forked:
    """A process forked from this program, asked as one of `subprocess` is."""

    def __init__(self, requests: socket.socket, *, loads_first: bool) -> None:
        if loads_first:
            preload()
            preload_kernels()
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

    def kill(self) -> None:
        self._fork.kill()


def _spawned(requests: socket.socket) -> _Process:
    return subprocess.Popen(  # noqa: S603
        run_by_new_interpreter(MODULE, str(requests.fileno())),
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
    loads_first
        Whether this program then loads what nodes need, kernels too, before it forks, as it needs the same itself.
        Else the server loads it, while the program does something else.

    """

    def __init__(self, *, from_here: bool = False, loads_first: bool = True) -> None:
        self._requests, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.users = 0
        """Contexts of `fork_server` under way."""
        self.is_replaceable = True
        """Whether another takes its place where it was ended by somebody else."""
        with theirs:
            self._process: _Process = _Forked(theirs, loads_first=loads_first) if from_here else _spawned(theirs)

    @property
    def pid(self) -> int:
        """Process id: that of the parent of the nodes."""
        return self._process.pid

    def has_ended(self) -> bool:
        """Whether it was ended by somebody else, and its nodes with it."""
        return self._process.poll() is not None

    def is_loading(self) -> bool:
        """Whether it does not take requests yet."""
        return not select.select([self._requests], [], [], 0)[0]

    def kill(self) -> None:
        """End it at once; nodes of it that are there leave."""
        self._process.kill()

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
        self.kill()  # it may be compiling kernels, for a minute in which it hears nothing
        self._process.wait()


_lock = threading.Lock()
_shared: ForkServerProcess | None = None


def end_loading_server() -> bool:
    """End the program's server if it has no nodes yet, as it still loads what they need; tell whether it was so.

    Whoever waits for a node gets a `RigError`, and whoever asks for one as long as the server's contexts last.
    """
    with _lock:
        if _shared is None or not _shared.is_loading():
            return False
        _shared.is_replaceable = False
        _shared.kill()
        return True


@contextmanager
def fork_server(*, from_here: bool = False, loads_first: bool = True) -> Iterator[ForkServerProcess]:
    """Give the program's server, which lives as long as one of these contexts.

    Several rigs one after the other start faster in a context of their own around all of them.

    Parameters
    ----------
    from_here
        Whether it may be forked from this program, which has no other thread and nothing of DDS yet.
    loads_first
        Of one that is: see `ForkServerProcess`.

    """
    global _shared  # noqa: PLW0603  # there is one a program
    with _lock:
        if _shared is None or (_shared.is_replaceable and _shared.has_ended()):
            _shared = ForkServerProcess(from_here=from_here, loads_first=loads_first)
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
