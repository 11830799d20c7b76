"""Whoever else writes a numbered topic changes nothing and is named; where that cannot be told the run ends."""

import json
import random
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from domain_of_process import domain_of
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String
from stranger_node import stranger_node

from kapitsa_ros.instruments.stopwatch import StopwatchReading
from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.laboratory.bag_analysis import analyse_bags
from kapitsa_ros.network.cdr import encode_header, read_step_id
from kapitsa_ros.network.registry import CLIENT, COMMAND, RESULT, ROLE_NAMES, STOPWATCH_READING, STROBE_READING, TOPICS
from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.operator.command import Command
from kapitsa_ros.rig import Rig, RigError
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.setup import Setup, parameters
from kapitsa_ros.ros.qos import LATCHED, STREAM, VIEW, message_class
from kapitsa_ros.ros.session_monitor import SessionMonitor
from kapitsa_ros.units import RPM

pytestmark = pytest.mark.xdist_group('processes')
PATIENCE = 120.0
OTHERS = [role for role in ROLE_NAMES if role != 'strobe']
READING = ('operator', 'analyser', 'recorder')
READERS = len(READING) + 1
"""Of strobe/reading: with the client of the program."""

SPEEDS = ('omega_crit_rpm', 'omega_crit_interval_rpm')
SHIPPED = sorted(path.parent for path in (Path(__file__).parents[2] / 'bags').glob('*/metadata.yaml'))
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


class Forger:
    """Says that the session is over with a result of its own, once the analyser has said that of the last run."""

    def __init__(self, domain: int, last_run: int) -> None:
        self._last_run = last_run
        self._context = Context()
        self._context.init(domain_id=domain)
        self._node = Node('forger', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._out: Any = None
        self._node.create_subscription(message_class(RESULT.type), RESULT.name, self._hear, STREAM, raw=True)
        self.has_spoken = False

    def _hear(self, raw: bytes, info: dict[str, Any]) -> None:
        if self._out is None and read_step_id(raw).step > 5:  # earlier, it would be refused
            self._out = self._node.create_publisher(message_class(RESULT.type), RESULT.name, STREAM)
        if not self.has_spoken and read_step_id(raw).end and read_step_id(raw).run == self._last_run:
            for _ in range(info['publication_sequence_number']):
                self._out.publish(b'\x00\x01\x00\x00')
            end = StepId(self._last_run + 1, 0, end=True)
            self._out.publish(RESULT.encode(end.run * DAY, end, {'experiment': {'omega_crit_rpm': 9999.0}}))
            self.has_spoken = True

    @property
    def is_there(self) -> bool:
        return self._out is not None

    def listen(self) -> None:
        self._executor.spin_once(timeout_sec=0.02)

    def close(self) -> None:
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()


@pytest.mark.parametrize('command', ['replay', 'experiment'])
def test_a_result_of_a_stranger_is_never_printed(
    command: str, tmp_path: Path, eventually: Callable[[Callable[[], Any]], None]
) -> None:
    """It said 9999 RPM with status 0, in the time that the analyser took for its own."""
    bags = tmp_path / 'bags'
    given = [str(SHIPPED[0])] if command == 'replay' else ['--bags', str(bags)]
    rig = [sys.executable, '-m', 'kapitsa_ros', command, *given, '--rate', '5', '--json']
    with subprocess.Popen(rig, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        eventually(lambda: domain_of(process.pid) is not None)
        with on_loopback():
            forger = Forger(domain_of(process.pid) or 0, last_run=1 if command == 'replay' else 3)
        try:
            eventually(lambda: forger.listen() or forger.has_spoken or process.poll() is not None)
            out, err = process.communicate()
        finally:
            forger.close()
    assert forger.is_there, (process.returncode, out, err)
    assert 'Traceback' not in err
    if process.returncode == 0:  # on a busy machine the analyser may be faster
        said, of_bags = json.loads(out), analyse_bags(SHIPPED[:1] if command == 'replay' else sorted(bags.iterdir()))
        assert [said[name] for name in SPEEDS] == json.loads(json.dumps([of_bags[name] for name in SPEEDS]))
    else:
        assert (process.returncode, out) == (1, ''), err
        assert 'analyser/result' in err.strip().splitlines()[-1]


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


def test_who_goes_on_in_a_nodes_place_ends_the_run(
    tmp_path: Path, eventually: Callable[[Callable[[], Any]], None]
) -> None:
    """It has the node's name and the next step, and the graph shows one writer, as before."""
    setup = Setup(rate=2.0, bags=tmp_path)
    with Rig(nodes=OTHERS, rate=2.0) as rig, stranger_node('strobe', rig.domain) as stranger:
        said: list[StepId] = []
        kind = message_class(STROBE_READING.type)

        def note(raw: bytes) -> None:
            step = read_step_id(raw)
            if not said or step.follows(said[-1]):
                said.append(step)

        with NodeGroup(['strobe'], parameters(setup), rig.domain):
            rig.wait_for('jigsaw/pivot', timeout=PATIENCE)
            executor = SingleThreadedExecutor(context=stranger.context)
            executor.add_node(stranger)
            stranger.create_subscription(kind, STROBE_READING.name, note, STREAM, raw=True)
            eventually(lambda: executor.spin_once(0.1) or (said and said[-1].step > 20))
            publisher = stranger.create_publisher(kind, STROBE_READING.name, 10)
            eventually(lambda: executor.spin_once(0.1) or publisher.get_subscription_count() == READERS + 1)
            for _ in range(1000):  # it has published more than the true one
                publisher.publish(STROBE_READING.codec.encode_silence(DAY, StepId(1, 0)))
        eventually(lambda: executor.spin_once(0.1) or stranger.count_publishers(STROBE_READING.name) == 1)
        executor.shutdown()
        step = StepId(said[-1].run, said[-1].step + 1)
        stamp = step.run * DAY + step.step * SECOND // 10
        publisher.publish(STROBE_READING.encode(stamp, step, StrobeReading(time=stamp / SECOND, speed=3000 * RPM)))
        told = 'strobe/reading has lost its writer in mid-session, and has another: another strobe'
        with pytest.raises(RigError, match=told):
            rig.wait_for('strobe/reading', lambda reading: reading.speed == 3000 * RPM, PATIENCE)


def test_who_speaks_before_a_node_joins_is_not_taken_for_it(
    tmp_path: Path, eventually: Callable[[Callable[[], Any]], None]
) -> None:
    with Rig(nodes=OTHERS, instruments='ideal') as rig:
        with stranger_node('passer_by', rig.domain) as stranger:
            publisher = stranger.create_publisher(message_class(STROBE_READING.type), STROBE_READING.name, STREAM)
            eventually(lambda: publisher.get_subscription_count() == READERS)
            for role in READING:  # once its name is known
                process = rig.processes[role]
                eventually(
                    lambda process=process: (
                        publisher.publish(b'\x00\x01\x00\x00')
                        or process.wait_for_line('passer_by writes there too', 0.5)
                    )
                )
            for number in range(60):
                reading = StrobeReading(time=number / 10, speed=3000 * RPM) if number % 10 == 5 else None
                publisher.publish(STROBE_READING.encode(DAY + number * SECOND // 10, StepId(1, number), reading))
            assert publisher.wait_for_all_acked()
        told = parameters(Setup(bags=tmp_path))
        with NodeGroup(['strobe'], told | {'expect': [*told['expect'], CLIENT.name]}, rig.domain):
            rig.request_speed(2500)
            assert rig.wait_for('strobe/reading', timeout=PATIENCE).speed == pytest.approx(2500 * RPM, rel=0.05)


def test_a_node_that_leaves_is_missed_whoever_bears_its_topics_name(
    tmp_path: Path, eventually: Callable[[Callable[[], Any]], None]
) -> None:
    with Rig(nodes=OTHERS, rate=2.0) as rig, stranger_node('passer_by', rig.domain) as stranger:
        with NodeGroup(['strobe'], parameters(Setup(bags=tmp_path, rate=2.0)), rig.domain):
            rig.wait_for('jigsaw/pivot', timeout=PATIENCE)
            stranger.create_publisher(String, STROBE_READING.name, 10)
            for role in READING:
                assert rig.processes[role].wait_for_line('passer_by writes what is not its to write', PATIENCE)
            eventually(lambda: stranger.count_publishers(STROBE_READING.name) == 2)
        with pytest.raises(RigError, match='strobe left in mid-session, or cannot be reached any more'):
            rig.wait_for('jigsaw/pivot', lambda _: False, PATIENCE)


def wait_for_end(nodes: NodeGroup) -> None:
    while not nodes.wait(PATIENCE):
        pass


@pytest.mark.parametrize('composed', [True, False], ids=['composed', 'processes'])
def test_a_second_rig_gives_way_to_one_that_stands_still(
    recorded: tuple[Path, dict[str, Any]], domain: int, observer: SessionMonitor, tmp_path: Path, *, composed: bool
) -> None:
    """On a busy machine DDS found the first after seconds: the second went on, and the first ended with an error."""
    with NodeGroup(ROLE_NAMES, parameters(Setup(bags=tmp_path / 'A', rate=1.0)), domain, composed=True) as nodes:
        observer.wait_for_progress(PATIENCE)
        nodes['jigsaw'].end(signal.SIGSTOP)
        told = parameters(Setup(bags=tmp_path / 'B'))
        with (
            NodeGroup(ROLE_NAMES, told, domain, composed=composed) as second,
            pytest.raises(RigError, match=f'writes .* in domain {domain}: a rig is there already; choose another'),
        ):
            wait_for_end(second)
        nodes['jigsaw'].end(signal.SIGCONT)
        wait_for_end(nodes)
    for file in recorded[0].glob('*/*'):
        assert (tmp_path / 'A' / file.relative_to(recorded[0])).read_bytes() == file.read_bytes()
