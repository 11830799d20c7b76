"""A numbered topic is taken from its one writer, and whoever else writes there is named."""

from types import SimpleNamespace
from typing import Any

import pytest

from kapitsa_ros.network.errors import SequenceError
from kapitsa_ros.network.registry import STROBE_READING
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.network.synchronizer import StepSynchronizer
from kapitsa_ros.ros.errors import NodeError
from kapitsa_ros.ros.numbered_subscription import NumberedSubscription
from kapitsa_ros.ros.qos import STREAM, VIEW

TOPIC = STROBE_READING.name
NAMELESS = '_NODE_NAME_UNKNOWN_'


class Graph:
    """A node's view of who writes; the test makes it up."""

    def __init__(self, *names: str) -> None:
        self.ends: dict[int, Any] = {}
        self.total = 0
        self.steps = StepSynchronizer([TOPIC])
        self.taken: list[int] = []
        self.refused: list[str] = []
        self.failed: list[Exception] = []
        self.reader = NumberedSubscription(self, STROBE_READING, self.take, self.refused.append, self.failed.append)
        for name in names:
            self.join(name)

    def create_subscription(
        self, _kind: Any, _name: str, receive: Any, _qos: Any, *, raw: bool, event_callbacks: Any
    ) -> None:
        assert raw
        self.receive, self.matched = receive, event_callbacks.matched

    def get_publishers_info_by_topic(self, topic: str) -> list[Any]:
        assert topic == TOPIC
        return list(self.ends.values())

    def take(self, step: StepId, raw: bytes) -> None:
        self.steps.put(TOPIC, step, raw)
        self.taken.append(step.step)

    def show(self, name: str, kind: str = STROBE_READING.type, qos: Any = STREAM) -> int:
        """Add an end, of which no match event tells."""
        gid = max(self.ends, default=0) + self.total + 1
        self.ends[gid] = SimpleNamespace(
            node_name=name, topic_type=kind, qos_profile=qos, endpoint_gid=[*gid.to_bytes(16)]
        )
        return gid

    def join(self, name: str) -> int:
        gid = self.show(name)
        self.total += 1
        self.tell(joined=1)
        return gid

    def leave(self, gid: int) -> None:
        del self.ends[gid]
        self.tell()

    def tell(self, *, joined: int = 0) -> None:
        heard = [
            end for end in self.ends.values() if end.topic_type == STROBE_READING.type and end.qos_profile == STREAM
        ]
        self.matched(SimpleNamespace(current_count=len(heard), total_count=self.total, total_count_change=joined))

    def say(self, number: int, *, publication: int | None = None, end: bool = False) -> None:
        step = StepId(2, 0, end=True) if end else StepId(1, number)
        raw = STROBE_READING.codec.encode_silence(86_400_000_000_000 + number * 100_000_000, step)
        self.receive((raw, {'publication_sequence_number': number + 1 if publication is None else publication}))


@pytest.mark.parametrize(
    ('stranger', 'error', 'said'),
    [
        ('', SequenceError, 'gap on strobe/reading: run 1 step 513 came after run 1 step 2'),
        (
            'stranger',
            NodeError,
            'gap on strobe/reading: run 1 step 513 came after run 1 step 2; it has a second writer, stranger',
        ),
    ],
)
def test_a_gap_names_the_second_writer_who_may_have_made_it(stranger: str, error: type[Exception], said: str) -> None:
    graph = Graph('strobe')
    for number in range(3):
        graph.say(number)
    if stranger:
        graph.join(stranger)
    assert not graph.failed
    graph.say(513, publication=4)
    assert (type(graph.failed[0]), str(graph.failed[0])) == (error, said)


@pytest.mark.parametrize(
    ('writers', 'strangers'),
    [
        (['strobe'], []),
        (['strobe', 'stranger'], ['stranger']),
        ([NAMELESS], []),
        ([NAMELESS, 'strobe'], ['a node without a name yet']),
        ([NAMELESS, 'stranger'], ['stranger']),
        ([NAMELESS, NAMELESS], ['a node without a name yet']),
        (['strobe', 'strobe'], ['another strobe']),
    ],
)
def test_the_topics_own_writer_is_no_stranger_before_its_name_is_known(
    writers: list[str], strangers: list[str]
) -> None:
    assert Graph(*writers).reader.strangers() == strangers


@pytest.mark.parametrize('stays', [True, False])
@pytest.mark.parametrize('publication', [4, 500])
def test_who_goes_on_in_the_writers_place_is_refused(publication: int, *, stays: bool) -> None:
    """It has the writer's name, the next step, and if it has counted along the next publication."""
    graph = Graph()
    own = graph.join('strobe')
    for number in range(3):
        graph.say(number)
    stranger = graph.join('strobe')
    graph.leave(own)
    if not stays:
        graph.leave(stranger)
    graph.say(3, publication=publication)
    assert graph.taken == [0, 1, 2]
    said = 'strobe/reading has lost its writer in mid-session, and has another: another strobe'
    assert str(graph.failed[0]) == said


def test_a_place_that_was_taken_between_two_looks_is_found() -> None:
    """Of a replacement there is one event: as many are matched as before."""
    graph = Graph()
    own = graph.join('strobe')
    graph.say(0)
    del graph.ends[own]
    graph.join('strobe')
    graph.say(1)
    assert graph.taken == [0]
    assert isinstance(graph.failed[0], NodeError)


def test_a_replacement_that_the_graph_shows_late_is_found() -> None:
    graph = Graph()
    own = graph.join('strobe')
    graph.say(0)
    graph.show('strobe')
    graph.matched(SimpleNamespace(current_count=1, total_count=2, total_count_change=1))
    assert not graph.failed
    del graph.ends[own]
    graph.say(1)
    assert graph.taken == [0]
    assert isinstance(graph.failed[0], NodeError)


def test_a_stranger_that_speaks_before_the_match_event_tells_of_it_is_refused() -> None:
    graph = Graph('strobe')
    graph.say(0)
    graph.show('stranger')
    graph.say(1, publication=500)
    graph.say(1)
    assert (graph.taken, graph.failed) == ([0, 1], [])
    assert graph.refused == ['strobe/reading: run 1 step 1, publication 500, comes from a second writer, stranger']


def test_the_writers_last_words_are_taken_and_a_link_that_was_cut_is_taken_up_again() -> None:
    graph = Graph()
    own = graph.join('strobe')
    graph.say(0)
    end = graph.ends[own]
    graph.leave(own)
    assert graph.reader.is_lost()
    graph.say(1)
    graph.ends[own] = end
    graph.total += 1
    graph.tell(joined=1)
    assert not graph.reader.is_lost()
    graph.say(2)
    assert (graph.taken, graph.failed) == ([0, 1, 2], [])


def test_who_spoke_before_the_writer_is_not_heard() -> None:
    graph = Graph()
    passer_by = graph.join('passer_by')
    assert graph.reader.is_lost()
    for number in range(60):
        graph.say(number)
    graph.leave(passer_by)
    graph.join('strobe')
    for number in range(3):
        graph.say(number)
    assert (graph.taken, graph.failed) == ([0, 1, 2], [])
    assert graph.refused[0] == 'strobe/reading: run 1 step 0 comes from passer_by, whose topic it is not'
    assert len(graph.refused) == 60


def test_who_was_heard_before_its_name_was_known_is_found_out() -> None:
    graph = Graph()
    gid = graph.join(NAMELESS)
    graph.say(0)
    graph.ends[gid].node_name = 'passer_by'
    graph.say(1)
    assert graph.taken == [0]
    assert str(graph.failed[0]) == 'strobe/reading was written by passer_by, whose topic it is not'


@pytest.mark.parametrize('publication', [1, 21])
def test_who_leaves_is_known_by_the_name_that_it_had(publication: int) -> None:
    """The graph forgets its name before it shows that it has left."""
    graph = Graph()
    gid = graph.join('passer_by')
    graph.say(0)
    graph.ends[gid].node_name = NAMELESS
    graph.say(publication - 1)
    assert graph.taken == []
    graph.leave(gid)
    graph.join('strobe')
    graph.say(0)
    assert (graph.taken, graph.failed) == ([0], [])


def test_who_has_no_name_yet_has_to_count_from_the_first() -> None:
    graph = Graph()
    graph.join(NAMELESS)
    graph.say(17, publication=21)
    assert graph.taken == []
    graph.say(0)
    assert (graph.taken, graph.failed) == ([0], [])


def test_last_words_that_are_read_when_the_writer_has_come_are_not_its_own() -> None:
    """Nor where no match event has told of anybody yet."""
    graph = Graph()
    graph.show('strobe')
    graph.say(17, publication=21)
    graph.say(0)
    assert (graph.taken, graph.failed) == ([0], [])
    said = 'run 1 step 17, publication 21, comes from a second writer, a node that has left'
    assert graph.refused == [f'strobe/reading: {said}']


def test_a_writer_may_leave_once_it_has_said_that_no_run_follows() -> None:
    graph = Graph()
    own = graph.join('strobe')
    graph.say(0, publication=1, end=True)
    graph.failed.clear()  # a run has begun at no step 0
    graph.join('passer_by')
    graph.leave(own)
    assert not graph.reader.is_lost()
    assert not graph.failed


@pytest.mark.parametrize(('kind', 'qos'), [('std_msgs/msg/String', STREAM), (STROBE_READING.type, VIEW)])
def test_what_only_bears_the_topics_name_does_not_stand_for_its_writer(kind: str, qos: Any) -> None:
    graph = Graph()
    own = graph.join('strobe')
    graph.show('strobe', kind, qos)
    graph.say(0)
    graph.leave(own)
    assert graph.reader.is_lost()
    assert not graph.failed
