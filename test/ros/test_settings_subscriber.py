"""The settings that describe a run are collected from the roles that have them."""

import json
from types import SimpleNamespace

import pytest

from kapitsa_ros.network.registry import REQUIRED_NAMES
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


def test_a_player_goes_from_bag_to_bag() -> None:
    settings, say, refused, failed = heard(frozenset({'player', 'analyser'}), ['player'])
    say('{"amplitude": 0.01}')
    say('{"amplitude": 0.02}')
    assert settings.texts['jigsaw'] == '{"amplitude": 0.02}'
    assert not refused
    assert not failed
