"""Which nodes of a process are polled, and when: with a clock that the test turns."""

from types import SimpleNamespace

import pytest

from kapitsa_ros.ros import node_loop
from kapitsa_ros.ros.node_loop import NodeLoop


class Node:
    """Counts how often it is polled."""

    def __init__(self) -> None:
        self.due, self.finished = 0.0, False
        self.polled, self.closed = 0, 0
        self.error: Exception | None = None

    def poll(self) -> float:
        self.polled += 1
        return 1.0

    def close(self) -> None:
        self.closed += 1
        if self.error is not None:
            raise self.error


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    clock = SimpleNamespace(now=100.0)
    monkeypatch.setattr(node_loop, 'time', SimpleNamespace(monotonic=lambda: clock.now))
    return clock


def polled(loop: NodeLoop, *nodes: Node) -> list[int]:
    for node in nodes:
        node.polled = 0
    loop.poll()
    return [node.polled for node in nodes]


def test_each_node_is_polled_when_it_is_due(clock: SimpleNamespace) -> None:
    one, other = nodes = [Node(), Node()]
    loop = NodeLoop(nodes)
    assert polled(loop, *nodes) == [1, 1]
    clock.now += 0.5
    assert polled(loop, *nodes) == [0, 0]
    other.due = 0.0  # a service was called
    assert polled(loop, *nodes) == [0, 1]
    assert loop.at_work is other
    one.due = clock.now + 0.2
    assert loop.poll() == pytest.approx(0.2)
    clock.now += 0.2
    assert polled(loop, *nodes) == [1, 0]
    clock.now += 0.9
    assert polled(loop, *nodes) == [0, 1]


def test_it_is_over_when_all_have_finished(clock: SimpleNamespace) -> None:
    one, other = nodes = [Node(), Node()]
    loop = NodeLoop(nodes)
    loop.poll()
    one.finished = True
    clock.now += 2.0
    loop.poll()
    assert not loop.is_over
    other.finished = True
    assert loop.poll() == 0.0
    assert loop.is_over
    assert [node.polled for node in nodes] == [1, 2]


def test_all_are_closed_where_one_cannot() -> None:
    nodes = [Node(), Node(), Node()]
    nodes[1].error = OSError('no space left')
    loop = NodeLoop(nodes)
    with pytest.raises(OSError, match='no space left'):
        loop.close()
    assert [node.closed for node in nodes] == [1, 1, 1]
    assert loop.at_work is nodes[1]
