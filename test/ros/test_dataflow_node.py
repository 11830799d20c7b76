"""A node of the dataflow network, in this process, beside others that the test makes."""

import os
import select
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from reader_that_takes_nothing import reader_that_takes_nothing

from kapitsa_ros.instruments.random_streams import random_stream
from kapitsa_ros.network.registry import PIVOT, RESULT, STROBE, STROBE_READING, WRITTEN
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.network.synchronizer import StepSynchronizer
from kapitsa_ros.network.topic import Topic
from kapitsa_ros.nodes.jigsaw import JigsawNode
from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.ros import dataflow_node
from kapitsa_ros.ros.dataflow_node import DataflowNode
from kapitsa_ros.ros.errors import NodeError
from kapitsa_ros.ros.instrument_node import InstrumentNode
from kapitsa_ros.ros.qos import STREAM, message_class
from kapitsa_ros.ros.step_node import StepNode

pytestmark = pytest.mark.xdist_group('processes')

MANY = 6000
"""More messages than the writer's history of 5000 holds."""
READER = f"""
import sys
import rclpy
from rclpy.node import Node
from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.registry import STROBE_READING
from kapitsa_ros.ros.qos import STREAM, message_class
rclpy.init(domain_id=int(sys.argv[1]))
node, steps = Node('stopped_reader'), []
kind, take = message_class(STROBE_READING.type), lambda raw: steps.append(read_step_id(raw).step)
node.create_subscription(kind, STROBE_READING.name, take, STREAM, raw=True)
print('listens', flush=True)
while len(steps) < {MANY}:
    rclpy.spin_once(node)
print(steps == list(range({MANY})), flush=True)
"""


@pytest.fixture
def ros(domain: int) -> Iterator[int]:
    """The default context, in which nodes of the rig are made."""
    with on_loopback():
        rclpy.init(domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
        yield domain
        rclpy.try_shutdown()


@contextmanager
def closing_node(node: Node) -> Iterator[None]:
    try:
        yield
    finally:
        node.destroy_node()


@contextmanager
def piped_stderr() -> Iterator[Callable[[], str]]:
    """Give what waits for a line on stderr; `capfd` loses what another thread writes while it is read."""
    lines, stderr = os.pipe()
    saved = os.dup(2)
    os.dup2(stderr, 2)

    def wait() -> str:
        ready, _, _ = select.select([lines], [], [], 180.0)
        return os.read(lines, 1000).decode() if ready else ''

    try:
        yield wait
    finally:
        os.dup2(saved, 2)
        for end in (lines, stderr, saved):
            os.close(end)


def test_a_full_writer_waits_names_the_reader_and_loses_nothing(
    ros: int, eventually: Callable[[Callable[[], Any]], None]
) -> None:
    reader = subprocess.Popen([sys.executable, '-c', READER, str(ros)], stdout=subprocess.PIPE, text=True)
    assert reader.stdout is not None
    assert reader.stdout.readline() == 'listens\n'
    node = DataflowNode(STROBE)
    try:
        eventually(
            lambda: (
                [end.node_name for end in node.get_subscriptions_info_by_topic(STROBE_READING.name)]
                == ['stopped_reader']
            )
        )
        reader.send_signal(signal.SIGSTOP)
        os.waitpid(reader.pid, os.WUNTRACED)
        sent = threading.Event()

        def emit_all() -> None:
            for step in range(MANY):
                node.emit_silence(STROBE_READING, StepId(1, step), step)
            sent.set()

        with piped_stderr() as line:
            threading.Thread(target=emit_all, daemon=True).start()
            assert 'strobe/reading is full: waiting for a reader that has stopped (stopped_reader)' in line()
        assert not sent.is_set()
        reader.send_signal(signal.SIGCONT)
        assert reader.stdout.readline() == 'True\n'
        assert sent.wait(60.0)
        assert reader.wait(60.0) == 0
    finally:
        reader.kill()
        reader.wait()
        reader.stdout.close()
        node.destroy_node()


@pytest.mark.parametrize('of_the_rig', [False, True])
def test_a_reader_that_takes_nothing_for_good_is_waited_for_if_it_is_of_the_rig(
    ros: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    eventually: Callable[[Callable[[], Any]], None],
    *,
    of_the_rig: bool,
) -> None:
    monkeypatch.setattr(dataflow_node, 'LEASE', 0.0)
    name = 'operator' if of_the_rig else 'sleeper'
    node = DataflowNode(STROBE)
    failed: list[Exception] = []

    def emit_all() -> None:
        try:
            for step in range(MANY):
                node.emit_silence(STROBE_READING, StepId(1, step), step)
        except NodeError as error:
            failed.append(error)

    with closing_node(node), reader_that_takes_nothing(STROBE_READING.name, name, ros, tmp_path) as reader:
        eventually(
            lambda: [end.node_name for end in node.get_subscriptions_info_by_topic(STROBE_READING.name)] == [name]
        )
        writing = threading.Thread(target=emit_all, daemon=True)
        with piped_stderr() as line:
            writing.start()
            named = 'operator)' if of_the_rig else 'sleeper), of which sleeper is not of this rig'
            assert f'strobe/reading is full: waiting for a reader that has stopped ({named}\n' in line()
        if of_the_rig:
            assert reader.stdin is not None
            reader.stdin.close()  # it leaves: the writer goes on
        writing.join(180.0)
        assert not writing.is_alive()
        told = (
            'strobe/reading has been full for 0 s: sleeper reads it, is not of this rig, and has to take what it reads'
        )
        assert [str(error).removesuffix(' or leave') for error in failed] == ([] if of_the_rig else [told])


@pytest.mark.parametrize('step', [StepId(1, 0), StepId(1, 7), StepId(2, 0, end=True)], ids=str)
@pytest.mark.parametrize('topic', [RESULT, WRITTEN], ids=lambda topic: topic.name)
def test_no_step_is_acknowledged_before_it_is_made(ros: int, topic: Topic[Any], step: StepId) -> None:  # noqa: ARG001
    """The jigsaw took a stranger's for the newest, and waited for one of the step before for ever."""
    node = JigsawNode()
    with closing_node(node), pytest.raises(NodeError, match=rf'{topic.name} acknowledges {step}, and run 1 step 0 is'):
        node.accept(topic.name, step, b'')


class Counting(StepNode):
    """Keeps the steps it is given."""

    def __init__(self) -> None:
        super().__init__(STROBE)
        self.steps, self.ended = [], []

    def work(self, step) -> None:
        self.steps.append((step.id, step[PIVOT].position[-1]))

    def end_run(self, step) -> None:
        self.ended.append(step.id)


def pivot_of(number: int) -> SampledMotion:
    return SampledMotion(1e-3, np.full(3, float(number)), np.zeros(3), np.zeros(3))


def test_steps_are_done_in_order_and_what_is_no_step_is_refused(
    ros: int,  # noqa: ARG001
    capfd: pytest.CaptureFixture[str],
    eventually: Callable[[Callable[[], Any]], None],
) -> None:
    node, jigsaw = Counting(), Node('jigsaw')
    publisher = jigsaw.create_publisher(message_class(PIVOT.type), PIVOT.name, STREAM)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        eventually(lambda: executor.spin_once(0.01) or publisher.get_subscription_count())
        messages = [PIVOT.encode(step, StepId(1, step), pivot_of(step)) for step in range(3)]
        end = PIVOT.codec.encode_silence(3, StepId(1, 3, end=True))
        for raw in (messages[0], messages[1], messages[1], b'\x00\x01\x00\x00 no step', messages[2], end):
            publisher.publish(raw)
        eventually(lambda: executor.spin_once(0.1) or (node.advance() and node.ended))
        assert node.steps == [(StepId(1, step), float(step)) for step in range(3)]
        assert node.ended == [StepId(1, 3, end=True)]
    finally:
        executor.shutdown()
        node.destroy_node()
        jigsaw.destroy_node()
    log = capfd.readouterr().err
    assert 'refused: a step of jigsaw/pivot that was there before (1 so far)' in log


class Probe(InstrumentNode):
    """An instrument that draws one random number."""

    def __init__(self) -> None:
        super().__init__(STROBE)
        self.drawn = None

    def instrument(self, random):
        self.drawn = random.random()
        return SimpleNamespace(observe=lambda start, motion: None)  # noqa: ARG005


def test_random_numbers_belong_to_the_role_whatever_the_node_is_called(domain: int) -> None:
    """D17."""
    with on_loopback():
        arguments = ['--ros-args', '-r', '__node:=lamp', '-p', 'seed:=7']
        rclpy.init(args=arguments, domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
        try:
            node = Probe()
            synchronizer = StepSynchronizer([PIVOT.name])
            synchronizer.put(PIVOT.name, StepId(1, 0), PIVOT.encode(0, StepId(1, 0), pivot_of(0)))
            node.work(synchronizer.take())
            assert node.get_name() == 'lamp'
            assert node.drawn == random_stream(7, 'strobe', 1).random()
            node.destroy_node()
        finally:
            rclpy.try_shutdown()
