"""Who has to be there before the first step, in a graph that the test makes up."""

import itertools
from pathlib import Path
from types import SimpleNamespace

import pytest

from kapitsa_ros.network.registry import PIVOT, REQUIRED_NAMES, STROBE, STROBE_READING, readers_of, topic_named
from kapitsa_ros.ros import peer_discovery
from kapitsa_ros.ros.errors import NodeError
from kapitsa_ros.ros.peer_discovery import DISCOVERY, LOST, PATIENCE, PeerDiscovery
from kapitsa_ros.ros.qos import STREAM


class Node:
    """Sees the graph that it is given; its clock is turned by the test."""

    def __init__(self) -> None:
        self.readers, self.writers, self.lines, self.now = {}, {}, [], 0.0
        self.processes: dict[str, int] = {}
        self.context = SimpleNamespace(get_domain_id=lambda: 42)

    def monotonic(self) -> float:
        return self.now

    def get_subscriptions_info_by_topic(self, topic: str):
        return [SimpleNamespace(node_name=name, endpoint_gid=self.gid(name)) for name in self.readers.get(topic, ())]

    def gid(self, name: str) -> list[int]:
        return [self.processes.get(name, 0)] * 16

    def get_publishers_info_by_topic(self, topic: str):
        return [
            SimpleNamespace(
                node_name=name.removesuffix(' of texts'),
                topic_type='std_msgs/msg/String' if name.endswith(' of texts') else topic_named(topic).type,
                qos_profile=STREAM,
                endpoint_gid=self.gid(name),
            )
            for name in self.writers.get(topic, ())
        ]

    def resolve_topic_name(self, topic: str) -> str:
        return topic

    def count_publishers(self, topic: str) -> int:
        return len(self.writers.get(topic, ()))

    def get_logger(self):
        return SimpleNamespace(info=self.lines.append)


@pytest.fixture
def node(monkeypatch: pytest.MonkeyPatch) -> Node:
    node = Node()
    monkeypatch.setattr(peer_discovery, 'time', node)
    return node


@pytest.fixture
def peers(node: Node) -> PeerDiscovery:
    return PeerDiscovery(node, STROBE.writes, STROBE.reads, frozenset(REQUIRED_NAMES))


def complete(node: Node) -> None:
    node.writers = {PIVOT.name: ['jigsaw'], STROBE_READING.name: ['strobe']}
    node.readers = {STROBE_READING.name: [*readers_of(STROBE_READING), 'a_stranger']}


def test_the_first_step_waits_for_every_expected_reader_and_writer(node: Node, peers: PeerDiscovery) -> None:
    assert not peers.ready()
    complete(node)
    del node.writers[PIVOT.name]
    assert not peers.ready()
    complete(node)
    for name in ('operator', 'analyser', 'recorder'):
        node.readers[STROBE_READING.name].remove(name)
        assert not peers.ready(), name
        node.readers[STROBE_READING.name].append(name)
    assert peers.ready()
    node.readers.clear()  # who leaves later does not stop the others
    assert peers.ready()


def test_readers_that_are_not_expected_are_not_waited_for(node: Node) -> None:
    peers = PeerDiscovery(node, STROBE.writes, STROBE.reads, frozenset({'jigsaw', 'operator'}))
    node.writers = {PIVOT.name: ['jigsaw']}
    node.readers = {STROBE_READING.name: ['operator']}
    assert peers.ready()


def test_the_hint_speaks_of_ros2_where_that_is(
    node: Node, peers: PeerDiscovery, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / 'ros2').touch(mode=0o755)
    monkeypatch.setenv('PATH', str(tmp_path))
    complete(node)
    node.readers[STROBE_READING.name].remove('analyser')
    node.now = 1.0 + PATIENCE
    peers.ready()
    assert node.lines == ['waiting for analyser in domain 42: start with `ros2 run kapitsa_ros NAME`']


def test_who_is_missing_is_said_at_growing_intervals(
    node: Node, peers: PeerDiscovery, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv('PATH', '')
    complete(node)
    node.readers[STROBE_READING.name].remove('analyser')
    said = []
    for node.now in range(int(20 * PATIENCE)):
        peers.ready()
        if len(node.lines) > len(said):
            said.append(node.now)
    assert node.lines[0] == 'waiting for analyser in domain 42: start with `kapitsa node NAME`'
    intervals = [after - before for before, after in zip([0, *said], said, strict=False)]
    assert intervals[0] == pytest.approx(PATIENCE, abs=1.5)
    assert all(after == pytest.approx(2 * before, abs=2.0) for before, after in itertools.pairwise(intervals))


def test_a_second_writer_of_a_topic_is_another_rig(node: Node, peers: PeerDiscovery) -> None:
    complete(node)
    node.writers[PIVOT.name].append('_NODE_NAME_UNKNOWN_')  # as rmw calls one that has said its topics first
    told = r'2 nodes write jigsaw/pivot in domain 42: a rig is there already \(a node without a name yet, jigsaw\)'
    with pytest.raises(NodeError, match=told):
        peers.ready()


def test_a_stranger_among_the_writers_is_named_for_what_it_is(node: Node, peers: PeerDiscovery) -> None:
    complete(node)
    node.writers[PIVOT.name].append('passer_by')
    with pytest.raises(NodeError, match=r'2 nodes write jigsaw/pivot in domain 42: passer_by is not of the rig \('):
        peers.ready()


@pytest.mark.parametrize('stranger', ['passer_by', 'jigsaw of texts'])
def test_a_stranger_is_not_taken_for_the_writer_that_is_waited_for(
    node: Node, peers: PeerDiscovery, stranger: str
) -> None:
    complete(node)
    node.writers[PIVOT.name] = [stranger]
    assert not peers.ready()


def test_what_only_bears_a_topics_name_is_no_second_writer(node: Node, peers: PeerDiscovery) -> None:
    complete(node)
    node.writers[PIVOT.name].append('passer_by of texts')
    assert peers.ready()
    assert peers.give_way()


def test_who_joined_a_moment_ago_gives_way_to_a_rig_that_it_finds_late(node: Node, peers: PeerDiscovery) -> None:
    complete(node)
    assert peers.ready()
    assert peers.give_way()
    node.now = DISCOVERY - 0.1
    node.writers[PIVOT.name].append('_NODE_NAME_UNKNOWN_')
    assert not peers.give_way()  # who that is will be known soon
    node.writers[PIVOT.name][1:] = ['passer_by']
    assert peers.give_way()  # what it says is refused
    node.writers[PIVOT.name][1:] = ['jigsaw']
    with pytest.raises(NodeError, match=r'2 nodes write jigsaw/pivot in domain 42: a rig is there already'):
        peers.give_way()
    node.now = DISCOVERY + 0.1
    assert peers.give_way()


def test_who_has_found_another_process_has_found_all_and_does_not_give_way_to_one_that_comes(
    node: Node, peers: PeerDiscovery
) -> None:
    complete(node)
    node.processes['recorder'] = 1
    assert peers.ready()
    node.writers[PIVOT.name].append('jigsaw')
    assert peers.give_way()


def test_who_is_out_of_reach_is_given_up(node: Node, peers: PeerDiscovery) -> None:
    def look(*lost: str, heard: bool = False) -> None:
        peers.refuse_lost(lost, heard=heard)

    look('jigsaw')
    node.now += LOST + 0.1
    look()  # it is back
    look('jigsaw')
    node.now += LOST + 0.1
    look('jigsaw', heard=True)  # its last word may be on its way
    look('jigsaw')
    node.now += LOST + 0.1
    with pytest.raises(NodeError, match=r'^jigsaw left in mid-session, or cannot be reached any more'):
        look('jigsaw')


def test_a_reader_that_was_through_first_may_leave(node: Node, peers: PeerDiscovery) -> None:
    complete(node)
    assert peers.ready()
    node.readers[STROBE_READING.name].clear()
    for _ in range(3):
        peers.refuse_lost((), heard=False)
        node.now += LOST + 0.1
