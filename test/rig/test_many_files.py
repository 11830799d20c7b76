"""A process with many open files starts rigs and leaves no node behind."""

import os
import resource
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

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
