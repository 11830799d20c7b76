"""The command line run in processes forked from one that has loaded it: a second is saved in each of hundreds of runs.

Each is a process of its own, which ends as an interpreter does. `python command_server.py FD` serves: for each request
it forks, and answers with the process id and then with the exit status.
"""

import json
import os
import signal
import socket
import subprocess
import sys
import threading
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import BinaryIO

_LONGEST = 1 << 20
_EXPENSIVE = ('kapitsa_ros.reporting.report', 'kapitsa_ros.rig.session')
"""What commands load when they need it, beside their own modules and those of nodes."""


class CommandServer:
    """Runs commands from here; one at a time."""

    def __init__(self) -> None:
        self._asking, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._lock = threading.Lock()
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, __file__, str(theirs.fileno())], pass_fds=[theirs.fileno()]
            )

    def run(
        self, arguments: list[str], environment: dict[str, str], out: BinaryIO, err: BinaryIO, timeout: float
    ) -> int:
        """Return the exit status, as `subprocess` gives it."""
        request = json.dumps([arguments, environment, str(Path.cwd())]).encode()
        with self._lock:
            socket.send_fds(self._asking, [request], [out.fileno(), err.fileno()])
            pid = json.loads(self._asking.recv(_LONGEST))
            self._asking.settimeout(timeout)
            try:
                return int(json.loads(self._asking.recv(_LONGEST)))
            except TimeoutError:
                os.kill(pid, signal.SIGKILL)
                self._asking.settimeout(None)
                self._asking.recv(_LONGEST)
                raise
            finally:
                self._asking.settimeout(None)

    def close(self) -> None:
        self._asking.close()
        self._process.wait()


def _load() -> None:
    from kapitsa_ros.cli import commands
    from kapitsa_ros.cli.main import main  # noqa: F401  # sets what numpy is to find
    from kapitsa_ros.network.registry import KERNEL_NAMES
    from kapitsa_ros.rig.fork_server import preload, preload_kernels

    for module in iter_modules(commands.__path__):
        import_module(f'{commands.__name__}.{module.name}')
    for name in _EXPENSIVE:
        import_module(name)
    preload()
    preload_kernels(KERNEL_NAMES)


def _serve(asking: socket.socket) -> None:
    """Return in each process that is forked, which is to run the command it finds in `sys.argv`."""
    while True:
        request, descriptors, _, _ = socket.recv_fds(asking, _LONGEST, 2)
        if not request:
            os._exit(0)
        pid = os.fork()
        if pid == 0:
            arguments, environment, folder = json.loads(request)
            for own, given in zip((1, 2), descriptors, strict=True):
                os.dup2(given, own)
                os.close(given)
            os.environ.clear()
            os.environ.update(environment)
            os.chdir(folder)
            sys.argv = ['kapitsa', *arguments]
            return
        for descriptor in descriptors:
            os.close(descriptor)
        asking.send(json.dumps(pid).encode())
        asking.send(json.dumps(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])).encode())


if __name__ == '__main__':
    with socket.socket(fileno=int(sys.argv[1])) as requests:
        _load()
        _serve(requests)
    from kapitsa_ros.cli.main import main

    main()
