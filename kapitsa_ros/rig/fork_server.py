"""`python -m kapitsa_ros.rig.fork_server SOCKET`: loads once what all nodes need, and forks a process for each.

Before a fork there is nothing of DDS, and no other thread but LTTng's, which wait for a tracer. A request is a datagram
of the names of nodes, with file descriptors: of a file with the request in JSON, of the nodes' parameters, of the pipe
that becomes their stderr, and of a socket on which the process id, with a descriptor of the process, and at last its
exit status is told, and when its end was noticed.
"""

from __future__ import annotations

import gc
import json
import os
import select
import signal
import socket
import sys
import time
import traceback
import warnings
from contextlib import contextmanager, suppress
from importlib import import_module
from typing import TYPE_CHECKING, NoReturn

import setproctitle

from kapitsa_ros.process_title import show_as
from kapitsa_ros.ros.arguments import NO_LOG_FILES, PARENT_OPTION
from kapitsa_ros.ros.signals import SIGNALS, leave_on_signals

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

DESCRIPTORS = 4
"""That come with a request."""
LONGEST = 1000
"""Bytes of a request: names of nodes."""
LOADED = b'loaded'
"""Said once, before the first request is taken."""
MODULE = 'kapitsa_ros.rig.fork_server'
"""Name under which this module is run, and under which `ps` shows it."""


@contextmanager
def forking() -> Iterator[None]:
    """Hold back signals: one that comes before Python has made itself at home in the child would be lost."""
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore', DeprecationWarning)  # Python 3.12 warns of LTTng's threads
            yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def serve_forked(requests: socket.socket) -> NoReturn:
    """Be, in a process forked from a program, what this module is when it is run."""
    leave_on_signals()
    signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
    os.setsid()
    number = requests.detach()
    null = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1):
        os.dup2(null, stream)
    os.closerange(3, number)
    os.closerange(number + 1, os.sysconf('SC_OPEN_MAX'))
    show_as(MODULE, str(number))
    preload()
    preload_kernels()
    with socket.socket(fileno=number) as asking:
        serve(asking)
    _leave(0)


def serve(requests: socket.socket) -> None:
    """Fork a node for each request, and tell how each ends, until the process that asks is gone or has no more to ask.

    First of all it is told that all is loaded. Nodes that still run at the end find that their parent is gone, and
    leave. One whose end nobody wants to hear of any more is asked to leave.
    """
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)  # where it is ignored, nobody is told of an exit status
    with suppress(BrokenPipeError):  # who asks may have left meanwhile: that is seen below
        requests.send(LOADED)
    nodes: dict[int, tuple[int, int]] = {}
    heard: dict[int, int] = {}
    poll = select.poll()
    poll.register(requests, select.POLLIN)
    while True:
        events = poll.poll()
        now = time.monotonic()
        for descriptor, _ in events:
            if descriptor == requests.fileno():
                message, descriptors = _request(requests)
                if not message:
                    return
                if len(descriptors) < DESCRIPTORS:  # the system has no more for this process
                    _close(descriptors)
                    continue
                *files, report = descriptors
                preload_kernels(message.decode().split())
                try:
                    pid, pidfd = _fork(files, requests)
                except OSError:  # the system has no process or descriptor left; who has asked sees the end closed
                    _close(descriptors)
                    continue
                _close(files)
                _tell(report, str(pid), pidfd)
                nodes[pidfd], heard[report] = (pid, report), pid
                poll.register(pidfd, select.POLLIN)
                poll.register(report, 0)  # its other end is closed: that is always told
            elif descriptor in heard:
                poll.unregister(descriptor)
                os.kill(heard.pop(descriptor), signal.SIGTERM)
            elif descriptor in nodes:
                poll.unregister(descriptor)
                os.close(descriptor)
                pid, report = nodes.pop(descriptor)
                if heard.pop(report, None):
                    poll.unregister(report)
                _tell(report, f'{os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])} {now:.6f}')
                os.close(report)


def _request(requests: socket.socket) -> tuple[bytes, list[int]]:
    """Return what is asked for, with file descriptors; nothing where nobody is there to ask any more."""
    try:
        message, descriptors, _, _ = socket.recv_fds(requests, LONGEST, DESCRIPTORS)
    except ConnectionResetError:  # who asked was killed, and had not read all that it was told
        return b'', []
    return message, descriptors


def _tell(report: int, text: str, *descriptors: int) -> None:
    """Send a datagram to whoever has asked for a node; who has closed it does not want to know."""
    with socket.socket(fileno=os.dup(report)) as end, suppress(BrokenPipeError, ConnectionResetError):
        socket.send_fds(end, [text.encode()], descriptors)


def _fork(files: list[int], requests: socket.socket) -> tuple[int, int]:
    """Make a process that becomes the node; return its id and a descriptor of it."""
    parent = os.getpid()
    with forking():
        pid = os.fork()
    if not pid:
        status = 1
        try:
            requests.detach()  # its destructor would close whatever has its number by then
            status = _become_node(files, parent)
        except BaseException:  # noqa: BLE001  # nothing of the server may go on in this process
            with suppress(Exception):  # whoever would read it may be gone
                traceback.print_exc()
        finally:
            _leave(status)
    try:
        return pid, os.pidfd_open(pid)
    except OSError:
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)
        raise


def _become_node(files: list[int], parent: int) -> int:
    from kapitsa_ros.nodes.__main__ import run_node  # noqa: PLC0415  # loaded long since

    request, parameters, stderr = files
    # A session of its own: Ctrl-C reaches the rig, which then ends its nodes in order.
    os.setsid()
    with open(os.dup(request), encoding='utf-8') as file:  # noqa: PTH123
        asked = json.load(file)
    null = os.open(os.devnull, os.O_RDWR)
    for number, descriptor in enumerate((null, null, stderr)):
        os.dup2(descriptor, number)
    os.closerange(3, parameters)
    os.closerange(parameters + 1, os.sysconf('SC_OPEN_MAX'))
    ros = [*NO_LOG_FILES, '--params-file', f'/proc/self/fd/{parameters}']
    name, *roles = asked['nodes']
    arguments = [name, PARENT_OPTION, str(parent), *roles, *ros]
    show_as('kapitsa_ros.nodes', *arguments)
    setproctitle.setthreadtitle(name)  # for `top` and `pkill`
    os.environ.clear()
    os.environ.update(asked['environment'])
    return run_node(arguments)


def _close(descriptors: list[int]) -> None:
    for descriptor in descriptors:
        os.close(descriptor)


def _leave(status: int) -> NoReturn:
    try:
        sys.stderr.flush()
    finally:
        os._exit(status)


def preload() -> None:
    """Load what the nodes would each load for themselves, but for kernels: modules and message types."""
    # Not above: the imports take a second, in which signals are heard already.
    from kapitsa_ros.network.registry import KERNEL_NAMES, NODE_NAMES, TOPICS  # noqa: PLC0415
    from kapitsa_ros.network.typestore import load_type  # noqa: PLC0415
    from kapitsa_ros.ros.type_support import (  # noqa: PLC0415
        OF_EVERY_NODE,
        OF_THOSE_THAT_KEEP_TIME,
        load_type_supports,
    )

    with _frozen():
        for name in NODE_NAMES:
            if name not in KERNEL_NAMES:
                import_module(f'kapitsa_ros.nodes.{name}')
        import_module('kapitsa_ros.ros.main')
        types = {topic.type for topic in TOPICS}
        for message_type in types:
            load_type(message_type)
        load_type_supports({*types, *OF_EVERY_NODE, *OF_THOSE_THAT_KEEP_TIME})


def preload_kernels(names: Iterable[str] | None = None) -> None:
    """Load the kernels of those nodes that run any, or of all."""
    from kapitsa_ros.network.registry import KERNEL_NAMES  # noqa: PLC0415  # as in `preload`

    for name in set(KERNEL_NAMES).intersection(KERNEL_NAMES if names is None else names) - _with_kernels:
        # What goes wrong here goes wrong in the node, too, which can tell of it.
        with _frozen(), suppress(Exception):
            import_module(f'kapitsa_ros.nodes.{name}').load_kernels()
        _with_kernels.add(name)


_with_kernels: set[str] = set()
"""Nodes whose kernels are loaded."""


@contextmanager
def _frozen() -> Iterator[None]:
    """Keep what is loaded in the context from being collected.

    In a node a collection would copy the pages that all share; on the way each would go over all that was loaded so
    far, a tenth of the time together.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


if __name__ == '__main__':
    leave_on_signals()
    os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
    show_as(MODULE, sys.argv[1])
    with socket.socket(fileno=int(sys.argv[1])) as asking:
        preload()
        serve(asking)
    _leave(0)
