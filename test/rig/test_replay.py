"""Recorded runs played like a recording: paused, stepped, sought, in part and in a loop, and analysed the same."""

import json
import os
import signal
import subprocess
import sys
import termios
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import rclpy
from domain_of_process import domain_of
from rcl_interfaces.srv import SetParameters
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from std_srvs.srv import Trigger

from kapitsa_ros.cli.replay_keys import replay_keys
from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.configuration.playback_parameters import PlaybackParameters
from kapitsa_ros.laboratory.bag_analysis import analyse_bags
from kapitsa_ros.network.registry import REPLAYED
from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.recording.playback import Playback
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig import session
from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.rig.errors import RigError, UsageError
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.session import replay_bags
from kapitsa_ros.rig.setup import REPLAY_NAMES, Replay, replay_parameters
from kapitsa_ros.ros.qos import LATCHED, VIEW
from kapitsa_ros.ros.session_monitor import SessionMonitor

SHIPPED = sorted(path.parent for path in (Path(__file__).parents[2] / 'bags').glob('*/metadata.yaml'))
PATIENCE = 180.0
FORGED = {'run': '1', 'simulated_s': '1.0', 'realtime_factor': '123456.0', 'session_over': 'False'}


class Audience:
    """Somebody who looks at a replay and has its remote control."""

    def __init__(self, node: Node, executor: SingleThreadedExecutor) -> None:
        self._node, self._executor = node, executor
        self.seconds: list[float] = []
        """Of the first run, at which what was shown took place."""
        node.create_subscription(JointState, 'joint_states', self._see, VIEW)

    def _see(self, state: JointState) -> None:
        stamp = state.header.stamp
        self.seconds.append(stamp.sec + stamp.nanosec / SECOND - DAY / SECOND)

    def call(self, name: str) -> str:
        """Call a service of the player, and return its answer."""
        client = self._node.create_client(Trigger, f'player/{name}')
        assert client.wait_for_service(PATIENCE)
        return self._answer(client.call_async(Trigger.Request())).message

    def set(self, name: str, value: float) -> str:
        """Set a parameter of the player, and return why it was refused."""
        client = self._node.create_client(SetParameters, 'player/set_parameters')
        assert client.wait_for_service(PATIENCE)
        request = SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
        return self._answer(client.call_async(request)).results[0].reason

    @contextmanager
    def another(self, name: str) -> Iterator[Node]:
        """Yield a node of another name in the same process."""
        node = Node(name, context=self._node.context)
        self._executor.add_node(node)
        yield node
        self._executor.remove_node(node)
        node.destroy_node()

    def watch(self, seen_enough: Callable[[], bool]) -> None:
        deadline = self._node.get_clock().now().nanoseconds + PATIENCE * SECOND
        while not seen_enough():
            assert self._node.get_clock().now().nanoseconds < deadline
            self._executor.spin_once(timeout_sec=0.1)

    def _answer(self, future: Any) -> Any:
        self._executor.spin_until_future_complete(future, PATIENCE)
        return future.result()


@contextmanager
def audience_in(domain: int) -> Iterator[Audience]:
    context = Context()
    with on_loopback():
        rclpy.init(context=context, domain_id=domain)
        node = Node('audience', context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    try:
        yield Audience(node, executor)
    finally:
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()


@contextmanager
def audience_of(replay: Replay, bags: list[Path] = SHIPPED[:1]) -> Iterator[tuple[Audience, SessionMonitor, NodeGroup]]:
    """Play bags to somebody; in a domain of their own."""
    with reserved_domain() as domain, audience_in(domain) as audience:
        with on_loopback():
            monitor = SessionMonitor(domain)
        told = replay_parameters(bags, replay) | {'expect': [*REPLAY_NAMES, 'session_monitor']}
        with monitor, NodeGroup(REPLAY_NAMES, told, domain) as nodes:
            yield audience, monitor, nodes


def test_playback_is_all_runs_end_to_end() -> None:
    bags = [RunBag(path) for path in SHIPPED]
    steps = list(Playback(bags).steps())
    assert [step.index for step in steps] == list(range(len(steps)))
    seconds = [step.seconds for step in steps]
    assert seconds == sorted(seconds)
    assert seconds[-1] == pytest.approx(Playback(bags).duration)
    assert [step.id.run for step in steps if step.id.end] == [1, 2, 3]
    messages = [raw for step in steps for raw in step.messages.values()]
    names = [topic.name for topic in REPLAYED]
    assert messages
    assert sorted(messages) == sorted(raw for bag in bags for _, _, raw in bag.raw(*names))


def test_the_end_of_a_part_is_after_its_start() -> None:
    with pytest.raises(ConfigurationError, match='the end, 2 s, is not after the start, 3 s'):
        PlaybackParameters(start=3.0, end=2.0)
    with pytest.raises(UsageError, match='--start is 5000 s: the runs last'):
        replay_bags(SHIPPED[:1], Replay(part=PlaybackParameters(start=5000.0)), lambda _: None)


def test_a_replay_is_paused_stepped_sought_and_analysed_as_ever() -> None:
    """Whatever was shown, skipped and shown again, the analyser has had every step once."""
    with audience_of(Replay(rate=5.0, start_paused=True)) as (audience, monitor, nodes):
        assert audience.call('pause') == 'paused already, before run 1 step 0'
        assert audience.call('step') == 'run 1 step 1'
        audience.watch(lambda: len(audience.seconds) > 0)
        assert audience.seconds[-1] == pytest.approx(0.1)  # the end of the first step
        assert audience.set('seek', 1e6).startswith('the runs last')
        assert not audience.set('seek', 6.0)
        audience.watch(lambda: audience.seconds[-1] > 6.1 - 1e-6)  # the end of the step there
        assert not [seconds for seconds in audience.seconds if 0.1 + 1e-6 < seconds < 6.0]
        assert not audience.set('seek', 2.0)
        audience.watch(lambda: 2.1 - 1e-6 < audience.seconds[-1] < 3.0)
        assert not audience.set('rate', 50.0)
        assert audience.call('toggle_paused') == 'run 1 step 21'
        audience.watch(lambda: nodes.wait(0.0))
        monitor.wait_for_end()
        back = next(number for number, seconds in enumerate(audience.seconds) if 2.0 < seconds < 3.0)
        assert audience.seconds[back:] == sorted(audience.seconds[back:])
    read = analyse_bags(SHIPPED[:1])
    assert monitor.runs[0].items() <= read['runs'][0].items()
    assert monitor.experiment.items() <= read.items()


def test_keys_steer_a_replay(monkeypatch: pytest.MonkeyPatch) -> None:
    person, terminal = os.openpty()
    with (
        os.fdopen(terminal, encoding='utf-8') as stdin,
        audience_of(Replay(rate=1.0, start_paused=True)) as (audience, monitor, _),
    ):
        monkeypatch.setattr('sys.stdin', stdin)
        control = monitor.time_control('player')
        before = termios.tcgetattr(terminal)
        with replay_keys(control, 1.0):
            audience.watch(control.is_served)
            # An answer tells that the player has found this audience, too: what it shows once is not missed.
            assert 'paused already' in audience.call('pause')
            os.write(person, b'\x1b[C')
            audience.watch(lambda: len(audience.seconds) > 0)
            assert audience.seconds[-1] <= 0.1 + 1e-6
            os.write(person, b'\x1b[A' * 10 + b' ')
            audience.watch(lambda: audience.seconds[-1] > 1.0)
            os.write(person, b' ')
            audience.watch(lambda: audience.call('step').startswith('run 1'))  # refused while time runs
        assert termios.tcgetattr(terminal) == before
    os.close(person)


def test_a_loop_shows_the_part_again_and_again_and_tells_the_result_once() -> None:
    part = PlaybackParameters(start=1.0, end=2.0)
    with audience_of(Replay(rate=10.0, part=part, loop=True)) as (audience, monitor, _):
        audience.watch(lambda: sum(later < earlier for earlier, later in pairwise(audience.seconds)) >= 3)
        monitor.wait_for_end()
        assert min(audience.seconds) > 1.0
        assert max(audience.seconds) <= 2.1 + 1e-6
        assert len(monitor.runs) == 1


@pytest.mark.slow
def test_the_command_line_plays_a_part_in_a_loop_until_it_is_interrupted(
    eventually: Callable[[Callable[[], Any]], None],
) -> None:
    how = ['--start', '1', '--end', '2', '--rate', '10', '--loop', '--start-paused', '--json']
    command = [sys.executable, '-m', 'kapitsa_ros', 'replay', str(SHIPPED[0]), *how]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            eventually(lambda: domain_of(process.pid) is not None)
            with audience_in(domain_of(process.pid) or 0) as audience:
                assert audience.call('step').startswith('run 1 step 1')
                audience.call('resume')
                audience.watch(lambda: sum(later < earlier for earlier, later in pairwise(audience.seconds)) >= 2)
                assert not audience.set('rate', 50.0)
                assert not audience.set('seek', 1.5)
                assert audience.call('pause').startswith('run 1 step 1')
            assert process.stdout is not None
            told = json.loads(process.stdout.readline())
        finally:
            process.send_signal(signal.SIGINT)  # else it would play for ever
    assert min(audience.seconds) > 1.0
    assert max(audience.seconds) <= 2.1 + 1e-6
    assert told['played_s'] == [1.0, 2.0]


def test_settings_of_another_player_end_a_replay() -> None:
    """They were believed: another seed and jitter of the stopwatch gave another critical speed without a word."""
    how = Replay(start_paused=True)
    with audience_of(how, SHIPPED[:2]) as (audience, _, nodes), audience.another('player') as player:
        heard: list[str] = []
        player.create_subscription(String, 'stopwatch/settings', lambda said: heard.append(said.data), LATCHED)
        audience.call('step')
        audience.watch(lambda: heard)
        settings = player.create_publisher(String, 'stopwatch/settings', LATCHED)
        audience.watch(lambda: settings.get_subscription_count() == 2)
        settings.publish(String(data=heard[0].replace('"seed": 1997', '"seed": 1998')))
        assert settings.wait_for_all_acked()
        audience.call('resume')
        with pytest.raises(RigError, match=r'^analyser died .*: stopwatch/settings has a second writer, player: which'):
            audience.watch(lambda: nodes.wait(0.0))


def test_a_result_that_is_not_of_the_bags_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever said it, and however: here the bags are others than those that are played."""
    monkeypatch.setattr(session, 'runs_of', lambda _: [RunBag(SHIPPED[1])])
    with pytest.raises(RigError, match=r'^analyser/result is not what the bags say: .*; choose another ROS_DOMAIN_ID'):
        replay_bags(SHIPPED[:1], Replay(), lambda _: None)


def test_a_replay_of_which_no_progress_was_heard_has_its_pace(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where it is over before the report of its player comes, or somebody else reports in its name."""
    monkeypatch.setattr(SessionMonitor, '_take_progress', lambda monitor, _: monitor.progress.update(FORGED))
    assert 0.0 < replay_bags(SHIPPED[:1], Replay(), lambda _: None)['realtime_factor'] < 123456.0


@pytest.mark.parametrize('rate', [0.0, 1000.0])
def test_part_of_the_runs_is_analysed_to_its_end(rate: float) -> None:
    """Of three runs the first two, and of the third what was recorded until then: nothing was timed there."""
    lengths = [Playback([RunBag(path)]).duration for path in SHIPPED]
    part = PlaybackParameters(start=lengths[0], end=lengths[0] + lengths[1] + 1.0)
    values = replay_bags(SHIPPED, Replay(rate=rate, part=part), lambda _: None)
    assert values['played_s'] == [part.start, part.end]
    whole = analyse_bags(SHIPPED)
    assert [run['period_s'] for run in values['runs']] == [*(run['period_s'] for run in whole['runs'][:2]), None]
    assert values['omega_crit_rpm'] == analyse_bags(SHIPPED[:2])['omega_crit_rpm']
