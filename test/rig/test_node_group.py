"""No node is left behind: with many open files, where waiting fails, where a start fails half-way."""

import errno
import os
import resource
import threading
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest

from kapitsa_ros.rig import node_group
from kapitsa_ros.rig.fork_server_process import ForkServerProcess, fork_server
from kapitsa_ros.rig.node_group import NodeGroup

SELECT_TAKES = 1024


@pytest.fixture
def many_files() -> Iterator[None]:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, min(hard, 2 * SELECT_TAKES)), hard))
    with ExitStack() as stack:
        for _ in range(SELECT_TAKES + 50):
            stack.enter_context(open(os.devnull))  # noqa: PTH123
        yield
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


@pytest.mark.usefixtures('many_files')
def test_nodes_are_watched_and_stopped_by_descriptors_that_select_cannot_take(domain: int) -> None:
    with NodeGroup(['pendulum'], {'expect': ['jigsaw', 'operator']}, domain) as nodes:
        assert nodes['pendulum'].sentinel >= SELECT_TAKES
        pid = nodes['pendulum'].pid
        assert nodes['pendulum'].wait_for_line('joins domain', 30.0)
        assert not nodes.wait(0.0)
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


@pytest.fixture
def server() -> Iterator[ForkServerProcess]:
    with fork_server() as process:
        yield process


def children(pid: int) -> set[int]:
    return {int(child) for child in Path(f'/proc/{pid}/task/{pid}/children').read_text().split()}


def test_nodes_are_gone_where_waiting_for_them_is_interrupted(
    domain: int, server: ForkServerProcess, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As by a second Ctrl-C while the first one stops them."""
    before = children(server.pid)
    nodes = NodeGroup(['pendulum', 'strobe'], {'expect': ['jigsaw', 'operator']}, domain)
    assert len(children(server.pid) - before) == 2

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(node_group, '_wait_until_readable', interrupt)
    with pytest.raises(KeyboardInterrupt):
        nodes.stop(60.0)
    assert children(server.pid) == before


def descriptors() -> list[str]:
    return sorted(path.name for path in Path('/proc/self/fd').iterdir())


def test_a_node_that_cannot_be_watched_is_not_left_running(
    domain: int, server: ForkServerProcess, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As where the last thread went into its start."""
    before, open_before = children(server.pid), descriptors()

    def refuse(*_: object, **__: object) -> None:
        raise OSError(errno.EAGAIN, 'no thread is left')

    monkeypatch.setattr(threading.Thread, 'start', refuse)
    with pytest.raises(OSError, match='no thread is left'):
        NodeGroup(['pendulum'], {'expect': ['jigsaw', 'operator']}, domain)
    assert children(server.pid) == before
    assert descriptors() == open_before


@pytest.mark.parametrize('left', range(6))
def test_a_node_that_finds_no_file_descriptor_is_not_left_running(
    left: int, domain: int, server: ForkServerProcess
) -> None:
    """Wherever in its start the last one goes."""
    before, open_before = children(server.pid), descriptors()
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    with ExitStack() as filled:
        filled.callback(resource.setrlimit, resource.RLIMIT_NOFILE, (soft, hard))
        resource.setrlimit(resource.RLIMIT_NOFILE, (max(map(int, open_before)) + 10, hard))
        taken: list[int] = []
        with suppress(OSError):
            while True:
                taken.append(os.open(os.devnull, os.O_RDONLY))
        for descriptor in taken[left:]:
            filled.callback(os.close, descriptor)
        for descriptor in taken[:left]:
            os.close(descriptor)
        with pytest.raises(OSError, match=r'descriptor|open files'):
            NodeGroup(['pendulum'], {'expect': ['jigsaw', 'operator']}, domain)
    assert children(server.pid) == before
    assert descriptors() == open_before


def test_nodes_are_heard_however_the_user_wants_lines_to_look(domain: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('RCUTILS_CONSOLE_OUTPUT_FORMAT', '[{name}] {message} ({function_name}() at {file_name})')
    monkeypatch.setenv('RCUTILS_LOGGING_USE_STDOUT', '1')
    with NodeGroup(['strobe'], {}, domain) as nodes:
        assert nodes['strobe'].wait_for_line('joins domain', 30.0)
        assert nodes['strobe'].has_joined
