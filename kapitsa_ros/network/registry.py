"""The one list of the graph's topics and roles; everything else that lists them is derived from it.

A sensor of one's own needs a codec, a topic and a role here, and a node of the role's name in `kapitsa_ros.nodes`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.codecs.acknowledgement import AcknowledgementCodec
from kapitsa_ros.network.codecs.command import CommandCodec
from kapitsa_ros.network.codecs.motion import MotionCodec
from kapitsa_ros.network.codecs.result import ResultCodec
from kapitsa_ros.network.codecs.stopwatch import StopwatchCodec
from kapitsa_ros.network.codecs.strobe import StrobeCodec
from kapitsa_ros.network.role import Role
from kapitsa_ros.network.topic import Topic

if TYPE_CHECKING:
    from collections.abc import Iterable

COMMAND = Topic('operator/command', CommandCodec())
PIVOT = Topic('jigsaw/pivot', MotionCodec('pivot'))
MOTION = Topic('pendulum/motion', MotionCodec('pendulum'))
STROBE_READING = Topic('strobe/reading', StrobeCodec(), reading=True)
STOPWATCH_READING = Topic('stopwatch/reading', StopwatchCodec(), reading=True)
RESULT = Topic('analyser/result', ResultCodec(), replayed=False)
WRITTEN = Topic('recorder/written', AcknowledgementCodec(), recorded=False, replayed=False)

TOPICS: tuple[Topic[Any], ...] = (COMMAND, PIVOT, MOTION, STROBE_READING, STOPWATCH_READING, RESULT, WRITTEN)
"""In the order in which a bag holds the messages of a step."""
RECORDED = tuple(topic for topic in TOPICS if topic.recorded)
REPLAYED = tuple(topic for topic in TOPICS if topic.replayed)
READINGS = tuple(topic for topic in TOPICS if topic.reading)
REQUESTS = ('operator/speed', 'operator/release')
"""Topics, not numbered, on which a person asks something of the operator: std_msgs/Float64."""

JIGSAW = Role(name='jigsaw', reads=(COMMAND, RESULT, WRITTEN), writes=(PIVOT,), describes_run=True)
PENDULUM = Role(
    name='pendulum', reads=(PIVOT, COMMAND), writes=(MOTION,), follows=(COMMAND,), describes_run=True, kernels=True
)
STROBE = Role(name='strobe', reads=(PIVOT,), writes=(STROBE_READING,), describes_run=True)
STOPWATCH = Role(name='stopwatch', reads=(MOTION,), writes=(STOPWATCH_READING,), describes_run=True)
OPERATOR = Role(name='operator', reads=(STROBE_READING, STOPWATCH_READING), writes=(COMMAND,))
ANALYSER = Role(name='analyser', reads=(*READINGS, COMMAND), writes=(RESULT,), follows=(COMMAND,))
RECORDER = Role(name='recorder', reads=RECORDED, writes=(WRITTEN,), follows=(COMMAND,))
PLAYER = Role(name='player', reads=(RESULT,), writes=REPLAYED)
SESSION_MONITOR = Role(name='session_monitor', reads=(RESULT,))
CLIENT = Role(name='client', reads=TOPICS)

RIG_ROLES = (JIGSAW, PENDULUM, STROBE, STOPWATCH, OPERATOR, ANALYSER, RECORDER)
"""Those of a laboratory at work, a process each."""
REPLAY_ROLES = (PLAYER, ANALYSER)
"""Those of a replay."""
NODES = (*RIG_ROLES, PLAYER)
"""Those that are executables of this package."""
_ALL = (*NODES, SESSION_MONITOR, CLIENT)

ROLE_NAMES = tuple(role.name for role in RIG_ROLES)
REQUIRED_NAMES = tuple(role.name for role in RIG_ROLES if not role.optional)
"""Those a node waits for by default."""
REPLAY_NAMES = tuple(role.name for role in REPLAY_ROLES)
"""Those the player waits for."""
NODE_NAMES = tuple(role.name for role in NODES)
KERNEL_NAMES = tuple(role.name for role in NODES if role.kernels)
"""Those that are started last: the others start while kernels are loaded."""
KNOWN_NAMES = frozenset(role.name for role in _ALL)


def writers_of(topic: Topic[Any]) -> frozenset[str]:
    """Return the names of the roles that write a topic: its own, or the player in its place."""
    return frozenset(role.name for role in NODES if topic in role.writes)


def writer_of(topic: Topic[Any]) -> Role:
    """Return the role whose topic it is."""
    return next(role for role in RIG_ROLES if topic in role.writes)


def readers_of(topic: Topic[Any]) -> frozenset[str]:
    """Return the names of the roles that read a topic."""
    return frozenset(role.name for role in _ALL if topic in role.reads)


def described_by(roles: Iterable[Role] = RIG_ROLES) -> tuple[str, ...]:
    """Return the names of the roles whose settings belong to a run."""
    return tuple(role.name for role in roles if role.describes_run)


def topic_named(name: str) -> Topic[Any]:
    """Return a topic by its name.

    Raises
    ------
    KeyError
        There is none.

    """
    return {topic.name: topic for topic in TOPICS}[name]
