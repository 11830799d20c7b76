"""Who writes a topic, in a graph that the test makes up: the real one shows nobody late at will."""

from types import SimpleNamespace

import pytest

from kapitsa_ros.network.registry import PIVOT
from kapitsa_ros.ros.node_names import UNKNOWN
from kapitsa_ros.ros.qos import STREAM
from kapitsa_ros.ros.writer_watch import WriterWatch


class Node:
    """Sees the graph that it is given: the names of writers by their ids."""

    def __init__(self) -> None:
        self.writers: dict[int, str] = {}

    def get_publishers_info_by_topic(self, topic: str) -> list[SimpleNamespace]:
        assert topic == PIVOT.name
        return [
            SimpleNamespace(node_name=name, topic_type=PIVOT.type, qos_profile=STREAM, endpoint_gid=[gid] * 16)
            for gid, name in self.writers.items()
        ]


def match(current: int, total: int, new: int) -> SimpleNamespace:
    return SimpleNamespace(current_count=current, total_count=total, total_count_change=new)


@pytest.fixture
def node() -> Node:
    return Node()


@pytest.fixture
def watch(node: Node) -> WriterWatch:
    """Of a topic whose writer was heard before its match event and its name."""
    watch = WriterWatch(node, PIVOT)
    node.writers = {1: UNKNOWN}
    assert watch.know(counts_from_the_first=True)
    watch.note_match(match(1, 1, 1))
    return watch


def test_the_only_writer_there_was_has_left_and_nobody_has_come(node: Node, watch: WriterWatch) -> None:
    """What came late had passed for somebody else's coming."""
    node.writers = {}
    watch.note_match(match(0, 1, 0))
    assert watch.is_gone
    assert watch.fault() is None


def test_who_takes_the_place_of_the_writer_is_named(node: Node, watch: WriterWatch) -> None:
    node.writers = {2: 'passer_by'}
    watch.note_match(match(1, 2, 1))
    assert watch.fault() == 'has lost its writer in mid-session, and has another: passer_by'


def test_who_came_and_left_with_the_writer_is_told_of(node: Node, watch: WriterWatch) -> None:
    node.writers = {}
    watch.note_match(match(0, 2, 1))
    assert watch.fault() == 'has lost its writer in mid-session, and has another: a node that has left'


def test_who_writes_beside_the_writer_is_a_stranger_and_no_fault(node: Node, watch: WriterWatch) -> None:
    node.writers = {1: 'jigsaw', 2: 'passer_by'}
    watch.note_match(match(2, 2, 1))
    assert watch.fault() is None
    assert watch.strangers() == ['passer_by']
    assert watch.is_steady


def test_a_writer_whose_name_says_that_the_topic_is_not_its_own_is_a_fault(node: Node, watch: WriterWatch) -> None:
    node.writers = {1: 'passer_by'}
    watch.refresh()
    assert watch.fault() == 'was written by passer_by, whose topic it is not'
