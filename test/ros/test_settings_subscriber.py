"""The settings that describe a run are collected from the roles that have them."""

import json
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

from kapitsa_ros.network.registry import REQUIRED_NAMES
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.ros.qos import LATCHED
from kapitsa_ros.ros.settings_subscriber import SettingsSubscriber


def test_all_settings_have_come_once_each_role_has_said_its_own():
    callbacks = {}
    node = SimpleNamespace(
        expected=frozenset(REQUIRED_NAMES),
        create_subscription=lambda _kind, topic, callback, _qos: callbacks.setdefault(topic, callback),
    )
    settings = SettingsSubscriber(node)
    assert set(callbacks) == {f'{role}/settings' for role in ('jigsaw', 'pendulum', 'strobe', 'stopwatch')}
    for number, (topic, callback) in enumerate(callbacks.items()):
        assert not settings.complete
        callback(SimpleNamespace(data=json.dumps({'node': topic, 'number': number})))
    assert settings.complete
    assert settings.parsed()['pendulum']['node'] == 'pendulum/settings'
    assert json.loads(settings.texts['strobe'])['node'] == 'strobe/settings'


def heard(expected: frozenset[str], writers: list[str]):
    """Return the subscriber of a node that it is part of, what it is called with, what was refused, and what failed."""
    callbacks, refused, failed = {}, [], []
    node = SimpleNamespace(
        expected=expected,
        create_subscription=lambda _kind, topic, callback, _qos: callbacks.setdefault(topic, callback),
        get_publishers_info_by_topic=lambda _: [SimpleNamespace(node_name=name) for name in writers],
        refuse=refused.append,
        keep_failure=failed.append,
    )
    settings = SettingsSubscriber(node)
    return settings, lambda text: callbacks['jigsaw/settings'](SimpleNamespace(data=text)), refused, failed


@pytest.mark.parametrize('text', ['', '{', '[1]', 'null', '[' * 90_000, '1' * 5000, '{"a": "' + 'x' * 10**6 + '"}'])
def test_what_is_no_settings_is_refused_and_changes_nothing(text: str) -> None:
    settings, say, refused, failed = heard(frozenset(REQUIRED_NAMES), ['jigsaw', 'stranger'])
    say('{"node": "jigsaw"}')
    say(text)
    assert settings.texts == {'jigsaw': '{"node": "jigsaw"}'}
    assert len(refused) == 1
    assert not failed


def test_settings_that_contradict_end_the_run_and_name_the_stranger() -> None:
    settings, say, _, failed = heard(frozenset(REQUIRED_NAMES), ['jigsaw', 'stranger'])
    say('{"amplitude": 0.01}')
    say('{"amplitude": 0.01}')
    assert not failed
    say('{"amplitude": 0.02}')
    assert str(failed[0]).startswith('jigsaw/settings has a second writer, stranger')
    assert settings.texts['jigsaw'] == '{"amplitude": 0.01}'


OF_A_REPLAY = frozenset({'player', 'analyser'})


def test_a_player_goes_from_bag_to_bag() -> None:
    settings, say, refused, failed = heard(OF_A_REPLAY, ['player'])
    for amplitude in ('0.01', '0.02', '0.02', '0.03'):
        say(f'{{"amplitude": {amplitude}}}')
        settings.begin_run()
    assert settings.texts['jigsaw'] == '{"amplitude": 0.03}'
    assert not refused
    assert not failed


@pytest.mark.parametrize('of_next_bag', ['{"amplitude": 0.01}', '{"amplitude": 0.02}'])
@pytest.mark.parametrize(
    ('writers', 'named'), [(['player', 'player'], 'player'), (['player'], 'a node that has left'), ([], 'a node')]
)
def test_settings_said_twice_for_a_bag_end_the_replay(of_next_bag: str, writers: list[str], named: str) -> None:
    """Who is called player was believed, and so was who had left."""
    settings, say, refused, failed = heard(OF_A_REPLAY, writers)
    say('{"amplitude": 0.01}')
    settings.begin_run()
    say(of_next_bag)
    assert not failed
    say('{"amplitude": 0.09}')
    assert str(failed[0]).startswith(f'jigsaw/settings has a second writer, {named}')
    assert len(refused) == 1
    assert settings.texts['jigsaw'] == of_next_bag


def test_settings_said_twice_before_the_first_run_end_the_replay() -> None:
    _, say, _, failed = heard(OF_A_REPLAY, ['player'])
    say('{"amplitude": 0.09}')
    say('{"amplitude": 0.01}')
    assert len(failed) == 1


def test_a_stranger_cannot_hide_what_the_player_says(
    domain: int, eventually: Callable[[Callable[[], Any]], None]
) -> None:
    """A reader that kept the newest text alone never had that of the player, where somebody else spoke often."""
    failed: list[Exception] = []
    context = Context()
    with on_loopback():
        context.init(domain_id=domain)
        reader, *others = (Node(name, context=context) for name in ('analyser', 'player', 'stranger'))
    reader.expected, reader.refuse, reader.keep_failure = OF_A_REPLAY, lambda _: None, failed.append
    SettingsSubscriber(reader, ('jigsaw',))
    executor = SingleThreadedExecutor(context=context)
    try:
        for number, other in enumerate(others):
            publisher = other.create_publisher(String, 'jigsaw/settings', LATCHED)
            eventually(publisher.get_subscription_count)
            publisher.publish(String(data=f'{{"amplitude": 0.0{number}}}'))
            assert publisher.wait_for_all_acked()
        executor.add_node(reader)
        eventually(lambda: executor.spin_once(timeout_sec=0.1) or failed)
        assert str(failed[0]).startswith('jigsaw/settings has a second writer, stranger')
    finally:
        executor.shutdown()
        for node in (reader, *others):
            node.destroy_node()
        context.try_shutdown()
