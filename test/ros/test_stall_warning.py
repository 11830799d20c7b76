"""A step that waits is said once, and once more when it goes on."""

import pytest

from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.ros import stall_warning
from kapitsa_ros.ros.stall_warning import PATIENCE, StallWarning


class Node:
    """Keeps what it logs; its clock is turned by the test."""

    def __init__(self) -> None:
        self.now, self.lines = 0.0, []

    def monotonic(self) -> float:
        return self.now

    def get_logger(self):
        return self

    def info(self, line: str) -> None:
        self.lines.append(('info', line))

    def warning(self, line: str) -> None:
        self.lines.append(('warning', line))


@pytest.fixture
def node(monkeypatch: pytest.MonkeyPatch) -> Node:
    node = Node()
    monkeypatch.setattr(stall_warning, 'time', node)
    return node


def test_a_long_wait_is_said_once_and_its_end_too(node: Node) -> None:
    stall = StallWarning(node)
    for node.now in (0.0, 0.9 * PATIENCE):
        stall.note(StepId(1, 7), ['pendulum/motion'])
    assert not node.lines
    for node.now in (1.1 * PATIENCE, 2 * PATIENCE, 10 * PATIENCE):
        stall.note(StepId(1, 7), ['pendulum/motion', 'strobe/reading'])
    waiting = ('warning', 'run 1 step 7 waits for pendulum/motion, strobe/reading: silent for 3 s')
    assert node.lines == [waiting]
    stall.note(StepId(1, 8), [])
    assert node.lines == [waiting, ('info', 'goes on at run 1 step 8 after 30 s')]


def test_steps_that_come_in_time_are_not_spoken_of(node: Node) -> None:
    stall = StallWarning(node)
    for step in range(10):
        stall.note(StepId(1, step), ['pendulum/motion'])
        node.now += 0.9 * PATIENCE
    assert not node.lines


def test_a_step_that_nothing_is_awaited_for_may_wait_for_ever(node: Node) -> None:
    """As one that is paused, or paced."""
    stall = StallWarning(node)
    for node.now in (0.0, 10 * PATIENCE, 20 * PATIENCE):
        stall.note(StepId(1, 3), [])
    assert not node.lines
