"""The one list of topics and roles, held against what it must not drift from."""

from importlib import import_module
from pathlib import Path

import kapitsa_ros.nodes
from kapitsa_ros.network import registry
from kapitsa_ros.ros.dataflow_node import DataflowNode

NODES = Path(kapitsa_ros.nodes.__file__).parent


def test_each_node_has_a_role_and_each_role_a_node() -> None:
    files = {path.stem for path in NODES.glob('[!_]*.py')}
    assert files == set(registry.NODE_NAMES)
    for name in registry.NODE_NAMES:
        assert issubclass(import_module(f'kapitsa_ros.nodes.{name}').create, DataflowNode)


def test_the_graph_is_the_one_the_readme_draws() -> None:
    """Written out by hand: what is derived is compared with what was agreed."""
    assert {topic.name: registry.readers_of(topic) for topic in registry.TOPICS} == {
        'operator/command': {'jigsaw', 'pendulum', 'analyser', 'recorder', 'client'},
        'jigsaw/pivot': {'pendulum', 'strobe', 'recorder', 'client'},
        'pendulum/motion': {'stopwatch', 'recorder', 'client'},
        'strobe/reading': {'operator', 'analyser', 'recorder', 'client'},
        'stopwatch/reading': {'operator', 'analyser', 'recorder', 'client'},
        'analyser/result': {'jigsaw', 'recorder', 'player', 'session_monitor', 'client'},
        'recorder/written': {'jigsaw', 'client'},
    }
    assert [topic.name for topic in registry.RECORDED] == [
        'operator/command', 'jigsaw/pivot', 'pendulum/motion', 'strobe/reading', 'stopwatch/reading', 'analyser/result',
    ]  # fmt: skip
    assert registry.described_by() == ('jigsaw', 'pendulum', 'strobe', 'stopwatch')


def test_a_topic_has_one_writer_and_the_player_stands_in_for_those_replayed() -> None:
    for topic in registry.TOPICS:
        writer = registry.writer_of(topic).name
        assert topic.name.startswith(f'{writer}/')
        assert registry.writers_of(topic) == ({writer, 'player'} if topic.replayed else {writer})
