"""The settings that describe a run are collected from the roles that have them."""

import json
from types import SimpleNamespace

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
