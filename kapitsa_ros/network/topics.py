"""The numbered topics of the dataflow network: who writes, who reads, of what type."""

from __future__ import annotations

from dataclasses import dataclass

ROLES = ('jigsaw', 'pendulum', 'strobe', 'stopwatch', 'operator', 'analyser', 'recorder')
"""The seven roles of the graph; `player` stands in for the first five when a bag is played."""


@dataclass(frozen=True)
class Topic:
    """A numbered topic: one message a step, from one writer."""

    name: str
    type: str
    writer: str
    readers: tuple[str, ...]


COMMAND = Topic(
    'operator/command',
    'sensor_msgs/msg/JointState',
    'operator',
    ('jigsaw', 'pendulum', 'analyser', 'recorder', 'client'),
)
PIVOT = Topic(
    'jigsaw/pivot', 'trajectory_msgs/msg/JointTrajectory', 'jigsaw', ('pendulum', 'strobe', 'recorder', 'client')
)
MOTION = Topic(
    'pendulum/motion', 'trajectory_msgs/msg/JointTrajectory', 'pendulum', ('stopwatch', 'recorder', 'client')
)
STROBE = Topic('strobe/reading', 'sensor_msgs/msg/JointState', 'strobe', ('operator', 'analyser', 'recorder', 'client'))
STOPWATCH = Topic(
    'stopwatch/reading', 'sensor_msgs/msg/TimeReference', 'stopwatch', ('operator', 'analyser', 'recorder', 'client')
)
RESULT = Topic(
    'analyser/result',
    'diagnostic_msgs/msg/DiagnosticArray',
    'analyser',
    ('jigsaw', 'recorder', 'player', 'observer', 'client'),
)
WRITTEN = Topic('recorder/written', 'std_msgs/msg/Header', 'recorder', ('jigsaw', 'client'))

RECORDED = (COMMAND, PIVOT, MOTION, STROBE, STOPWATCH, RESULT)
"""In the order in which a bag holds the messages of a step."""
PLAYED = RECORDED[:-1]
"""What the player puts back; results are made anew."""

SETTINGS_TYPE = 'std_msgs/msg/String'
"""Of NODE/settings: JSON, latched."""


def writers_of(topic: Topic) -> set[str]:
    """Return the roles that may write a topic: its own, or the player."""
    return {topic.writer, 'player'} if topic in PLAYED else {topic.writer}


def settings_topic(node: str) -> str:
    """Return the topic on which a node latches its settings."""
    return f'{node}/settings'
