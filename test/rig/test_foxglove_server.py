"""The live view: what a client of Foxglove's protocol sees, and what it may do, beside a rig and a replay that run."""

import math
import re
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterEvent, ParameterValue
from rcl_interfaces.srv import GetParameters, ListParameters
from rclpy.executors import SingleThreadedExecutor
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Header, String
from trajectory_msgs.msg import JointTrajectory

from kapitsa_ros.configuration.urdf import urdf
from kapitsa_ros.network.registry import MOTION
from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.network.typestore import deserialise
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.recording.playback import Playback
from kapitsa_ros.recording.reader import RunBag, runs_of
from kapitsa_ros.rig import Rig
from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.environment import node_environment
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.setup import REPLAY_NAMES, Replay, replay_parameters
from kapitsa_ros.ros.arguments import FOXGLOVE_SERVER
from kapitsa_ros.ros.qos import LATCHED, STREAM, VIEW

pytest.importorskip('foxglove', reason='needs foxglove-sdk: pip install "kapitsa_ros[foxglove]"')
pytest.importorskip('websockets')
from foxglove_client import PATIENCE, PAUSE, PLAY, FoxgloveClient
from stranger_node import stranger_node

from kapitsa_ros.live_view.frame_transforms import encode_transforms, joints_of
from kapitsa_ros.live_view.replay_timeline import ReplayTimeline

pytestmark = pytest.mark.xdist_group('viewers')
SHIPPED = sorted(path.parent for path in (Path(__file__).parents[2] / 'bags').glob('*/metadata.yaml'))


@contextmanager
def serving(domain: int, *bags: Path) -> Iterator[FoxgloveClient]:
    """Start the server as `kapitsa node` does, and connect to it."""
    given = ['-p', 'port:=0', *(['-p', f'bags:=[{",".join(map(str, bags))}]'] if bags else [])]
    process = subprocess.Popen(
        [sys.executable, '-m', 'kapitsa_ros.nodes', FOXGLOVE_SERVER, '--ros-args', *given],
        env=node_environment(domain),
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stderr is not None
        said = next(line for line in process.stderr if 'serves Foxglove' in line)
        found = re.search(r'ws://127\.0\.0\.1:(\d+)$', said.strip())
        assert found
        with FoxgloveClient(int(found[1])) as client:
            yield client
        process.terminate()
        assert process.wait(timeout=180) == 0
    finally:
        process.kill()
        process.wait()
        process.stderr.close()


def test_a_client_sees_a_rig_and_works_at_it() -> None:
    with Rig(rate=1.0, composed=True) as rig, serving(rig.domain) as client:
        client.subscribe('/pendulum/motion', '/joint_states', '/tf', '/robot_description', '/diagnostics')
        client.publish('/operator/speed', 262.0)
        client.publish('/operator/release', 0.25)
        topics = ('/pendulum/motion', '/joint_states', '/tf', '/robot_description', '/diagnostics')
        client.until(lambda: all(client.messages[topic] for topic in topics) and client.times)
        assert client.call('/jigsaw/pause')[0]
        succeeded, why = client.call('/jigsaw/pause')
        assert not succeeded
        assert why.startswith('paused already, before run 1')
        client.settle(0.5)
        count = len(client.messages['/pendulum/motion'])
        assert client.call('/jigsaw/step')[0]
        client.until(lambda: len(client.messages['/pendulum/motion']) == count + 1)

        assert client.get('/jigsaw.rate', '/pendulum.length')['/pendulum.length'] == Plant().length
        client.watch('/jigsaw.rate')
        client.set('/jigsaw.rate', 2)  # JSON knows no doubles
        client.until(lambda: client.parameters.get('/jigsaw.rate') == 2.0)
        client.set('/jigsaw.rate', -1)
        client.set('/pendulum.length', 1.0)
        client.until(lambda: len(client.warnings) == 2)
        assert '/jigsaw.rate' in client.warnings[0]
        assert 'read-only' in client.warnings[1]
        assert client.get('/jigsaw.rate', '/pendulum.length') == {
            '/jigsaw.rate': 2.0,
            '/pendulum.length': Plant().length,
        }
        rig.set_rate(3.0)  # what others do is seen, too
        client.until(lambda: client.parameters.get('/jigsaw.rate') == 3.0)

        # Topics with a writer of their own are closed, and the run goes on.
        client.publish('/pendulum/motion', 1.0)
        client.publish('/operator/speed', 1.0, 'std_msgs/msg/String')
        client.until(lambda: len(client.warnings) == 4)
        assert client.warnings[2:] == [
            '/pendulum/motion is not open to clients: publish on operator/speed or operator/release',
            '/operator/speed takes std_msgs/msg/Float64, not std_msgs/msg/String',
        ]
        client.publish('/operator/release', math.nan)  # the operator's to refuse
        assert client.call('/jigsaw/resume')[0]
        assert rig.wait_for('operator/command', lambda command: command.speed == 262.0, timeout=PATIENCE)
        succeeded, next_run = client.call('/jigsaw/reset')
        assert (succeeded, next_run) == (True, 'run 2 step 0')
        client.until(lambda: client.times[-1] > 2 * DAY)
        assert rig.wait_for('operator/command', lambda command: command.hold is not None, timeout=PATIENCE)

        # A client that comes later is told what is latched, and only it.
        with FoxgloveClient(client.port) as second:
            second.subscribe('/robot_description')
            second.until(lambda: second.messages['/robot_description'])
        assert len(client.messages['/robot_description']) == 1


def test_a_client_plays_a_replay_and_sees_what_is_recorded() -> None:
    bags = SHIPPED[:2]
    told = replay_parameters(bags, Replay(rate=1.0, loop=True, start_paused=True))
    timeline = ReplayTimeline(runs_of(bags))
    with reserved_domain() as domain, NodeGroup(REPLAY_NAMES, told, domain), serving(domain, *bags) as client:
        client.subscribe('/pendulum/motion', '/joint_states')
        client.until(lambda: '/player/pause' in client.services and client.playback)
        start, end = (
            client.info[name]['sec'] * SECOND + client.info[name]['nsec'] for name in ('dataStartTime', 'dataEndTime')
        )
        assert (start, end) == timeline.range_ns
        assert end - start == round(Playback(runs_of(bags)).duration * SECOND)
        assert client.playback[-1]['status'] == 'paused'
        deadline = time.monotonic() + PATIENCE
        while not client.messages['/pendulum/motion']:  # a run is shown once: not before the server has subscribed
            assert time.monotonic() < deadline
            assert client.call('/player/step')[0]
            client.settle(0.5)
        assert client.control(PLAY, 3.0)['status'] == 'playing'
        client.until(lambda: len(client.messages['/pendulum/motion']) > 40)
        state = client.control(PAUSE, 1.0, start + 3 * SECOND)
        assert state == {
            'status': 'paused',
            'time': start + 3 * SECOND,
            'speed': 1.0,
            'sought': True,
            'request': state['request'],
        }
        client.until(lambda: client.times[-1] == start + 3 * SECOND)
        assert client.call('/player/toggle_paused')[0]  # by somebody else
        client.until(lambda: client.playback[-1]['status'] == 'playing')
        assert client.get('/player.rate') == {'/player.rate': 1.0}
        state = client.control(PAUSE, 1.0, end - SECOND)
        client.until(lambda: client.times[-1] >= end - SECOND)  # in the second run, a day later
        assert state['time'] == end - SECOND
    motion = client.decoded('/pendulum/motion')
    recorded = {stamp: raw for _, stamp, raw in RunBag(bags[0]).raw(MOTION.name)}
    curve = 0
    for at, message in motion:
        stamp = message.header.stamp.sec * SECOND + message.header.stamp.nanosec
        assert at == timeline.time_at(stamp)
        if stamp in recorded and message.points:
            block = MOTION.decode(recorded[stamp])
            assert np.array_equal([point.positions[0] for point in message.points], block.position)
            curve += len(message.points)
    assert curve > 3000


def test_the_frames_are_where_physics_has_the_links() -> None:
    plant = Plant(length=0.4, amplitude=0.03)
    joints = joints_of(urdf(plant))
    for height, angle in ((0.0, 0.0), (0.02, 0.12), (-0.03, -1.4)):
        raw = encode_transforms(joints, {'pivot': height, 'pendulum': angle}, 7 * SECOND + 5)
        frames = {item.child_frame_id: item for item in deserialise('tf2_msgs/msg/TFMessage', raw).transforms}
        assert [(item.header.frame_id, name) for name, item in frames.items()] == [
            ('jigsaw', 'blade'),
            ('blade', 'rod'),
            ('rod', 'tip'),
        ]
        place, turn = np.zeros(3), 0.0
        for frame in frames.values():
            shift, quaternion = frame.transform.translation, frame.transform.rotation
            place += [
                shift.x * math.cos(turn) + shift.z * math.sin(turn),
                shift.y,
                shift.z * math.cos(turn) - shift.x * math.sin(turn),
            ]
            turn += 2 * math.atan2(quaternion.y, quaternion.w)
            assert frame.header.stamp.nanosec == 5
        wanted = [plant.length * math.sin(angle), 0.0, height + plant.length * math.cos(angle)]
        assert place == pytest.approx(wanted, abs=1e-12)


def test_nonsense_on_the_graph_ends_no_view(domain: int) -> None:
    """Times of no rig, joints at NaN, parameters of no type, a second type of a topic: each ended the server."""
    nothing, later = ParameterValue(type=99), Header(stamp=Time(sec=DAY // SECOND))
    beyond = [Header(stamp=Time(sec=-3)), Header(stamp=Time(sec=2**31 - 1, nanosec=2**32 - 1))]
    asked = []

    def name_two(_: Any, response: ListParameters.Response) -> ListParameters.Response:
        response.result.names = ['a', 'b']
        return response

    def give_one(request: GetParameters.Request, response: GetParameters.Response) -> GetParameters.Response:
        asked.append(request)
        response.values = [nothing]
        return response

    with (
        stranger_node('other', domain) as other,
        stranger_node('pendulum', domain, serves_parameters=False) as stranger,
    ):
        other.create_publisher(Time, '/clock', 10)  # its type comes before the right one in the alphabet
        executor = SingleThreadedExecutor(context=stranger.context)
        executor.add_node(stranger)
        stranger.create_service(ListParameters, 'pendulum/list_parameters', name_two)
        stranger.create_service(GetParameters, 'pendulum/get_parameters', give_one)
        model = stranger.create_publisher(String, 'robot_description', LATCHED)
        model.publish(String(data=urdf(Plant())))
        events = stranger.create_publisher(ParameterEvent, '/parameter_events', 10)
        clock = stranger.create_publisher(Clock, '/clock', VIEW)
        state = stranger.create_publisher(JointState, 'joint_states', VIEW)
        motion = stranger.create_publisher(JointTrajectory, 'pendulum/motion', STREAM)
        with serving(domain) as client:
            client.subscribe('/pendulum/motion', '/tf', '/clock')

            def speak() -> None:
                events.publish(
                    ParameterEvent(node='/pendulum', new_parameters=[ParameterMessage(name='x', value=nothing)])
                )
                for header, angle in [(beyond[0], 0.1), (beyond[1], 0.1), (later, math.nan), (later, 0.1)]:
                    clock.publish(Clock(clock=header.stamp))
                    state.publish(JointState(header=header, name=['pendulum'], position=[angle]))
                    motion.publish(JointTrajectory(header=header))
                    executor.spin_once(timeout_sec=0.05)
                    client.settle(0.05)  # of the clock and the joints the server takes the newest alone

            deadline = time.monotonic() + PATIENCE
            while not (asked and client.times and client.messages['/pendulum/motion'] and client.messages['/tf']):
                assert time.monotonic() < deadline
                speak()
            for _ in range(3):
                model.publish(String(data='<robot'))
                speak()
            assert {*client.times, *(at for at, _ in client.messages['/pendulum/motion'])} == {DAY}
        executor.shutdown()


@pytest.mark.parametrize(
    'text',
    [
        '',
        '<robot',
        '<robot><joint/></robot>',
        '<!DOCTYPE r [<!ENTITY a "b">]><r/>',
        '<r><joint name="a" type="fixed"><origin xyz="1"/></joint></r>',
    ],
)
def test_what_is_no_model_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r'.'):
        joints_of(text)


def test_runs_of_the_same_number_have_no_common_timeline() -> None:
    with pytest.raises(ValueError, match='two of these runs have the same number'):
        ReplayTimeline(runs_of([SHIPPED[0], SHIPPED[0]]))


def test_a_port_that_is_taken_is_named(domain: int) -> None:
    with socket.create_server(('127.0.0.1', 0)) as taken:
        port = taken.getsockname()[1]
        arguments = [FOXGLOVE_SERVER, '--ros-args', '-p', f'port:={port}']
        done = subprocess.run(
            [sys.executable, '-m', 'kapitsa_ros.nodes', *arguments],
            env=node_environment(domain),
            capture_output=True,
            text=True,
            timeout=180,
            check=False,
        )
    assert done.returncode == 2
    assert (
        done.stderr.splitlines()[-1]
        == f'foxglove_server: error: parameter port: 127.0.0.1:{port} cannot be listened on: give another'
    )
