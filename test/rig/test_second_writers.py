"""Whoever else writes a numbered topic changes nothing, is named, and takes no node with it."""

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

from kapitsa_ros.instruments.stopwatch import StopwatchReading
from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.network.cdr import encode_header
from kapitsa_ros.network.registry import COMMAND, ROLE_NAMES, STOPWATCH_READING, STROBE_READING, TOPICS
from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.operator.command import Command
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.setup import Setup, parameters
from kapitsa_ros.ros.qos import LATCHED, STREAM, VIEW, message_class
from kapitsa_ros.ros.session_monitor import SessionMonitor

pytestmark = pytest.mark.xdist_group('processes')

WELL_FORMED = {
    COMMAND: Command(speed=200.0, hold=None),
    STROBE_READING: StrobeReading(time=1.0, speed=200.0),
    STOPWATCH_READING: StopwatchReading(pressed_at=2.0, displayed=1.5, swings=3, kind='timed'),
}


class Stranger:
    """Writes all numbered topics, each message numbered as the next of the rig's own would be, or as nonsense is."""

    def __init__(self, domain: int) -> None:
        self._random = random.Random(1997)
        self._context = Context()
        self._context.init(domain_id=domain)
        self._node = Node('stranger', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self.last: StepId | None = None
        self._steps_before = 0
        self._node.create_subscription(Clock, '/clock', self._note, VIEW)
        self._out = {
            topic: self._node.create_publisher(message_class(topic.type), topic.name, STREAM) for topic in TOPICS
        }
        self._diagnostics = self._node.create_publisher(DiagnosticArray, 'diagnostics', 10)
        self._settings = self._node.create_publisher(String, 'jigsaw/settings', LATCHED)
        self.said = 0

    def _note(self, message: Clock) -> None:
        time = message.clock.sec * SECOND + message.clock.nanosec
        last, self.last = self.last, StepId(time // DAY, time % DAY // (SECOND // 10))
        if last and last.run < self.last.run:
            self._steps_before += last.step

    def listen(self) -> None:
        self._executor.spin_once(timeout_sec=0.02)

    def speak(self) -> None:
        """Say something on each topic; so seldom that its publications are fewer than those of the topic's writer."""
        if 3 * self.said > len(TOPICS) * (self._steps_before + self.last.step):
            return
        for topic, publisher in self._out.items():
            run, step = self.last.run, self.last.step
            number = self._random.choice(
                [
                    StepId(run, step), StepId(run, step + 1), StepId(run, max(0, step - 8)), StepId(run, step + 500),
                    StepId(run, step + 1, end=True), StepId(run + 1, 0), StepId(run + 1, 0, end=True), StepId(1, 0),
                ]
            )  # fmt: skip
            value = WELL_FORMED.get(topic)
            bodies = [
                topic.codec.encode_silence(run * DAY, number),
                encode_header(run * DAY, number) + b'\xff' * 64,
                encode_header(run * DAY, number) + b'x' * 100_000,
                b'\x00\x01\x00\x00' + bytes(8) + b'\xff\xff\xff\x7f' + b'run 1 step ' + b'9' * 100_000,
            ]
            bodies += [topic.encode(run * DAY, number, value)] * 3 if value else []
            publisher.publish(self._random.choice(bodies))
            self.said += 1
        pairs = [KeyValue(key='run', value='many'), KeyValue(key='session_over', value='x' * 1000)]
        self._diagnostics.publish(
            DiagnosticArray(status=[DiagnosticStatus(name='jigsaw: progress', values=pairs), DiagnosticStatus()])
        )
        self._settings.publish(String(data='[' * 10_000))

    def close(self) -> None:
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()


def test_strangers_change_nothing_and_are_named(
    recorded: tuple[Path, dict[str, Any]],
    tmp_path: Path,
    domain: int,
    observer: SessionMonitor,
    eventually: Callable[[Callable[[], Any]], None],
) -> None:
    setup = Setup(bags=tmp_path / 'A', rate=6.0)
    with NodeGroup(ROLE_NAMES, parameters(setup), domain) as nodes:
        eventually(lambda: int(observer.progress.get('step', 0)) > 3)  # all have found one another
        with on_loopback():
            stranger = Stranger(domain)
        try:
            eventually(lambda: stranger.listen() or stranger.last or nodes.wait(0.0))
            while not nodes.wait(0.0):
                stranger.listen()
                if not observer.session_over:
                    stranger.speak()
        finally:
            stranger.close()
        refusals = nodes.refusals()
        complaints = {role: nodes[role].last_error_lines() for role in ROLE_NAMES}
    observer.wait_for_end()
    assert stranger.said > 10 * len(TOPICS)
    assert any(line.startswith('operator has refused: ') for line in refusals)
    assert any('a second writer, stranger' in line for line in refusals), refusals
    assert all(len(line) < 300 for line in refusals)
    assert all(len(line) < 300 for lines in complaints.values() for line in lines.split('; '))
    for run in recorded[1]['runs']:
        name = Path(run['bag']).name
        for file in (recorded[0] / name).iterdir():
            assert (tmp_path / 'A' / name / file.name).read_bytes() == file.read_bytes()
