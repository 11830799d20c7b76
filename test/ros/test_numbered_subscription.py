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

TOPIC = STROBE_READING.name


@pytest.mark.parametrize(
    ('writers', 'error', 'said'),
    [
        (['strobe'], SequenceError, 'gap on strobe/reading: run 1 step 513 came after run 1 step 2'),
        (
            ['strobe', 'stranger'],
            NodeError,
            'gap on strobe/reading: run 1 step 513 came after run 1 step 2; it has a second writer, stranger',
        ),
    ],
)
def test_a_gap_names_the_second_writer_who_may_have_made_it(
    writers: list[str], error: type[Exception], said: str
) -> None:
    kept: dict[str, Any] = {}

    def subscribe(_kind: Any, _name: str, receive: Any, _qos: Any, *, raw: bool, event_callbacks: Any) -> None:
        assert raw
        kept.update(receive=receive, match=event_callbacks.matched)

    node = SimpleNamespace(
        create_subscription=subscribe,
        get_publishers_info_by_topic=lambda _: [SimpleNamespace(node_name=name) for name in writers],
    )
    steps = StepSynchronizer([TOPIC])
    failed: list[Exception] = []
    NumberedSubscription(
        node, STROBE_READING, lambda step, raw: steps.put(TOPIC, step, raw), pytest.fail, failed.append
    )
    kept['match'](SimpleNamespace(current_count=1))
    for number in range(3):
        say(kept['receive'], number, publication=number + 1)
    kept['match'](SimpleNamespace(current_count=len(writers)))
    assert not failed
    say(kept['receive'], 513, publication=4)
    assert (type(failed[0]), str(failed[0])) == (error, said)


@pytest.mark.parametrize(
    ('writers', 'strangers'),
    [
        (['strobe'], []),
        (['strobe', 'stranger'], ['stranger']),
        (['_NODE_NAME_UNKNOWN_'], []),
        (['_NODE_NAME_UNKNOWN_', 'strobe'], ['a node without a name yet']),
        (['_NODE_NAME_UNKNOWN_', 'stranger'], ['stranger']),
        (['_NODE_NAME_UNKNOWN_', '_NODE_NAME_UNKNOWN_'], ['a node without a name yet']),
    ],
)
def test_the_topics_own_writer_is_no_stranger_before_its_name_is_known(
    writers: list[str], strangers: list[str]
) -> None:
    node = SimpleNamespace(
        create_subscription=lambda *_, **__: None,
        get_publishers_info_by_topic=lambda _: [SimpleNamespace(node_name=name) for name in writers],
    )
    source = NumberedSubscription(node, STROBE_READING, pytest.fail, pytest.fail, pytest.fail)
    assert source.strangers() == strangers


def say(receive: Any, number: int, *, publication: int) -> None:
    step = StepId(1, number)
    raw = STROBE_READING.codec.encode_silence(86_400_000_000_000 + number * 100_000_000, step)
    receive((raw, {'publication_sequence_number': publication}))
