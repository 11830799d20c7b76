"""The topics of the dataflow network: who writes, who reads, of what type."""

from __future__ import annotations

from dataclasses import dataclass

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState, TimeReference
from std_msgs.msg import Header, String
from trajectory_msgs.msg import JointTrajectory

STREAM = QoSProfile(
    history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.VOLATILE
)
LATCHED = QoSProfile(
    depth=1,
    history=HistoryPolicy.KEEP_LAST,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
VIEW = QoSProfile(depth=1, history=HistoryPolicy.KEEP_LAST, reliability=ReliabilityPolicy.BEST_EFFORT)

NODES = ('jigsaw', 'pendulum', 'strobe', 'stopwatch', 'operator', 'analyser', 'recorder')
"""The seven roles of the graph; `player` stands in for the first five when a bag is played."""


@dataclass(frozen=True)
class Topic:
    """A numbered topic: one message a step, from one writer."""

    name: str
    type: type
    writer: str
    readers: tuple[str, ...]


COMMAND = Topic('operator/command', JointState, 'operator', ('jigsaw', 'pendulum', 'analyser', 'recorder'))
PIVOT = Topic('jigsaw/pivot', JointTrajectory, 'jigsaw', ('pendulum', 'strobe', 'recorder'))
MOTION = Topic('pendulum/motion', JointTrajectory, 'pendulum', ('stopwatch', 'recorder'))
STROBE = Topic('strobe/reading', JointState, 'strobe', ('operator', 'analyser', 'recorder'))
STOPWATCH = Topic('stopwatch/reading', TimeReference, 'stopwatch', ('operator', 'analyser', 'recorder'))
RESULT = Topic('analyser/result', DiagnosticArray, 'analyser', ('jigsaw', 'recorder'))
WRITTEN = Topic('recorder/written', Header, 'recorder', ('jigsaw',))

RECORDED = (COMMAND, PIVOT, MOTION, STROBE, STOPWATCH, RESULT)
"""In the order in which a bag holds the messages of a step."""
PLAYED = RECORDED[:-1]
"""What the player puts back; results are made anew."""

SETTINGS_OF = ('jigsaw', 'pendulum', 'strobe', 'stopwatch')
"""Nodes that publish their parameters, latched, on NODE/settings."""
SETTINGS_TYPE = String
