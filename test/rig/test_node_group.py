"""No node is left behind: with many open files, where waiting fails, where a start fails half-way."""

import errno
import os
import resource
import threading
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from kapitsa_ros.rig import node_group
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
        assert nodes['pendulum'].pidfd >= SELECT_TAKES
        pid = nodes['pendulum'].pid
        assert nodes['pendulum'].wait_for_line('joins domain', 30.0)
        assert not nodes.wait(0.0)
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def children() -> set[int]:
    """Process ids of the children of all threads of this process."""
    tasks = Path('/proc/self/task').iterdir()
    return {int(pid) for task in tasks for pid in (task / 'children').read_text().split()}


def test_nodes_are_gone_where_waiting_for_them_is_interrupted(domain: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """As by a second Ctrl-C while the first one stops them."""
    before = children()
    nodes = NodeGroup(['pendulum', 'strobe'], {'expect': ['jigsaw', 'operator']}, domain)
    assert len(children() - before) == 2

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(node_group, '_wait_until_readable', interrupt)
    with pytest.raises(KeyboardInterrupt):
        nodes.stop(60.0)
    assert children() == before


@pytest.mark.parametrize('failing', ['pidfd_open', 'thread'])
def test_a_node_that_cannot_be_watched_is_not_left_running(
    failing: str, domain: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As where the last free file descriptor or thread went into its start."""
    before = children()

    def refuse(*_: object, **__: object) -> None:
        raise OSError(errno.EMFILE, 'too many open files')

    monkeypatch.setattr(*((os, 'pidfd_open') if failing == 'pidfd_open' else (threading.Thread, 'start')), refuse)
    with pytest.raises(OSError, match='too many open files'):
        NodeGroup(['pendulum'], {'expect': ['jigsaw', 'operator']}, domain)
    assert children() == before
