"""The graph is real processes: they can be listed, stopped, killed, slowed and started by hand."""

import os
import random
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from stranger_node import stranger_node

from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.network.registry import MOTION, RECORDED, ROLE_NAMES, WRITTEN, readers_of, writer_of
from kapitsa_ros.rig import shared_memory
from kapitsa_ros.rig.environment import node_environment, on_loopback
from kapitsa_ros.rig.errors import RigError
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.setup import Setup, parameters
from kapitsa_ros.rig.shared_memory import remove_stale_segments, stale_segments
from kapitsa_ros.ros.qos import STREAM, message_class
from kapitsa_ros.ros.session_monitor import SessionMonitor

Kapitsa = Callable[..., Any]
Recorded = tuple[Path, dict[str, Any]]
PATIENCE = 180.0
pytestmark = pytest.mark.xdist_group('processes')


def setup_of(bags: Path, *, rate: float = 0.0, preset: str = 'ideal') -> Setup:
    return Setup(plant=load_preset(preset), bags=bags, rate=rate)


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob('*')) if path.is_file()}


def carry_out(nodes: NodeGroup) -> None:
    """Wait until the session is over."""
    deadline = time.monotonic() + PATIENCE
    while not nodes.wait(1.0):
        assert time.monotonic() < deadline, f'{[r for r in ROLE_NAMES if nodes[r].status() is None]} still run'


def types_of(node: Node) -> dict[str, list[str]]:
    """Return the topics that a node has heard of, each with its types."""
    return dict(node.get_topic_names_and_types())


def test_ros_sees_seven_nodes_and_their_topics(
    domain: int, observer: SessionMonitor, tmp_path: Path, eventually: Callable[[Callable[[], bool]], None]
) -> None:
    context = Context()
    with on_loopback():
        rclpy.init(context=context, domain_id=domain)
        stranger = Node('stranger', context=context)
    expected = {
        topic.name: (writer_of(topic).name, readers_of(topic) & set(ROLE_NAMES)) for topic in (*RECORDED, WRITTEN)
    }

    def graph() -> dict[str, tuple[str, set[str]]]:
        """Discovery tells of each end in its own time, and of a node's name after its topics."""
        return {
            name: (
                ', '.join(end.node_name for end in stranger.get_publishers_info_by_topic(name)),
                {end.node_name for end in stranger.get_subscriptions_info_by_topic(name)} & set(ROLE_NAMES),
            )
            for name in expected
        }

    kinds = {f'/{topic.name}': [topic.type] for topic in (*RECORDED, WRITTEN)} | {
        '/joint_states': ['sensor_msgs/msg/JointState'],
        '/clock': ['rosgraph_msgs/msg/Clock'],
    }

    with NodeGroup(ROLE_NAMES, parameters(setup_of(tmp_path, rate=1.0)), domain):
        try:
            observer.wait_for_progress(PATIENCE)
            eventually(lambda: graph() == expected)
            assert set(ROLE_NAMES) <= set(stranger.get_node_names())
            # For the ends of these topics no node has waited.
            eventually(lambda: types_of(stranger).keys() >= kinds.keys())
            assert {name: kind for name, kind in types_of(stranger).items() if name in kinds} == kinds
        finally:  # before the others leave: see kapitsa_ros/ros/shutdown.py
            stranger.destroy_node()
            context.try_shutdown()


def test_dds_uses_loopback_alone(domain: int, observer: SessionMonitor, tmp_path: Path) -> None:
    with NodeGroup(ROLE_NAMES, parameters(setup_of(tmp_path, rate=1.0)), domain) as nodes:
        observer.wait_for_progress(PATIENCE)
        inodes = set()
        for role in ROLE_NAMES:
            for link in Path(f'/proc/{nodes[role].pid}/fd').iterdir():
                with suppress(FileNotFoundError):  # closed since
                    inodes.add(str(link.readlink()).removeprefix('socket:[').removesuffix(']'))
        mapped = [
            f'{role}: {line}'
            for role in ROLE_NAMES
            for line in Path(f'/proc/{nodes[role].pid}/maps').read_text().splitlines()
            if 'fastrtps_port' in line
        ]
        rows = [line.split() for line in Path('/proc/net/udp').read_text().splitlines()[1:]]
        bound = [row[1].split(':') for row in rows if row[9] in inodes]
    first = 7400 + 250 * domain  # RTPS specification, 9.6.1.1
    addresses = {address for address, port in bound if first <= int(port, 16) < first + 250}
    assert addresses == {'0100007F'}
    # Whatever sends has a port that the system gave: our transport sends nothing, or each datagram would go twice.
    assert not [port for address, port in bound if address == '0100007F' and int(port, 16) >= 32768]
    # Ports in shared memory are common to all domains: who is killed while it holds one stalls the others.
    assert not mapped


def test_nodes_started_by_hand_in_any_order_give_the_same_bags(recorded: Recorded, tmp_path: Path, domain: int) -> None:
    order = list(ROLE_NAMES)
    random.Random(1997).shuffle(order)
    environment = node_environment(domain)
    processes = []
    try:
        for role in order:
            arguments = [sys.executable, '-m', 'kapitsa_ros', 'node', role]
            if role == 'recorder':
                arguments += ['--ros-args', '-p', f'bags:={tmp_path / "A"}']
            processes.append(subprocess.Popen(arguments, env=environment, stderr=subprocess.PIPE, text=True))
            time.sleep(4 / len(order))  # spread over four seconds: what is tested, not a wait for something
        for role, process in zip(order, processes, strict=True):
            _, err = process.communicate(timeout=PATIENCE)
            assert process.returncode == 0, f'{role}: {err}'
    finally:
        for process in processes:
            process.kill()
            process.wait()
    assert files(tmp_path / 'A') == files(recorded[0])


def test_whoever_is_missing_is_named(domain: int) -> None:
    process = subprocess.Popen(
        [sys.executable, '-m', 'kapitsa_ros', 'node', 'pendulum'],
        env=node_environment(domain), stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        assert process.stderr is not None
        line = next(line for line in process.stderr if 'waiting' in line)
        assert 'jigsaw, operator, recorder, stopwatch' in line
        assert f'domain {domain}' in line
    finally:
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=10)
    assert process.returncode == 0
    assert 'Traceback' not in err


SLOW_RECORDER = """
import sys, time
import kapitsa_ros.nodes.recorder as recorder
from kapitsa_ros.nodes.__main__ import main

class Slow(recorder.RecorderNode):
    def accept(self, topic, tick, raw):
        time.sleep(0.001)
        return super().accept(topic, tick, raw)

recorder.create = Slow
sys.exit(main(['recorder', *sys.argv[1:]]))
"""


def test_a_slow_recorder_slows_the_rig_and_loses_nothing(recorded: Recorded, tmp_path: Path, domain: int) -> None:
    others = [role for role in ROLE_NAMES if role != 'recorder']
    command = [sys.executable, '-c', SLOW_RECORDER, '--ros-args', '-p', f'bags:={tmp_path / "A"}']
    with NodeGroup(others, parameters(setup_of(tmp_path / 'A')), domain) as nodes:
        slow = subprocess.Popen(command, env=node_environment(domain))
        try:
            carry_out(nodes)
            assert slow.wait(10) == 0
        finally:
            slow.kill()
            slow.wait()
    assert files(tmp_path / 'A') == files(recorded[0])


def test_a_recorder_stopped_for_a_while_loses_nothing(
    recorded: Recorded, tmp_path: Path, domain: int, observer: SessionMonitor
) -> None:
    with NodeGroup(ROLE_NAMES, parameters(setup_of(tmp_path / 'A', rate=5.0)), domain) as nodes:
        observer.wait_for_progress(PATIENCE)
        nodes['recorder'].end(signal.SIGSTOP)
        assert not nodes.wait(5.0), 'the session ended without its recorder'
        nodes['recorder'].end(signal.SIGCONT)
        carry_out(nodes)
    assert files(tmp_path / 'A') == files(recorded[0])


ECHO = """
import rclpy
from trajectory_msgs.msg import JointTrajectory
from kapitsa_ros.ros.qos import STREAM

rclpy.init()
node = rclpy.create_node('echo')
node.create_subscription(JointTrajectory, 'pendulum/motion', lambda _: print('.', end='', flush=True), STREAM)
print('ready', flush=True)
while not any(info.node_name == 'pendulum' for info in node.get_publishers_info_by_topic('pendulum/motion')):
    rclpy.spin_once(node, timeout_sec=0.01)
print('They know each other', flush=True)
rclpy.spin(node)
"""


def test_somebody_elses_reader_that_hangs_is_named_once_and_loses_nothing(
    recorded: Recorded, tmp_path: Path, domain: int
) -> None:
    echo = subprocess.Popen([sys.executable, '-c', ECHO], env=node_environment(domain), stdout=subprocess.PIPE)
    assert echo.stdout is not None
    try:
        assert echo.stdout.readline() == b'ready\n'
        # At a pace at which the rig is not through before the two know each other.
        with NodeGroup(ROLE_NAMES, parameters(setup_of(tmp_path / 'A', rate=5.0)), domain) as nodes:
            assert select.select([echo.stdout], [], [], PATIENCE)[0]
            assert b'They know each other' in echo.stdout.readline()
            assert echo.stdout.read(10) == 10 * b'.'
            echo.send_signal(signal.SIGSTOP)
            assert nodes['pendulum'].wait_for_line('waiting for a reader that has stopped', PATIENCE)
            echo.send_signal(signal.SIGCONT)
            carry_out(nodes)
            [line] = [line for line in nodes['pendulum'].last_error_lines().split('; ') if 'has stopped' in line]
            assert 'pendulum/motion' in line
            assert 'echo' in line
    finally:
        echo.kill()
        echo.communicate()
        remove_stale_segments()
    assert files(tmp_path / 'A') == files(recorded[0])


# The owner of time, an instrument, and the one that writes the bag: a node group treats all its nodes alike.
@pytest.mark.parametrize('role', ['jigsaw', 'stopwatch', 'recorder'])
def test_a_node_that_is_killed_ends_the_experiment(
    role: str,
    processes_of: Callable[[int], dict[str, int]],
    shared_memory_of: Callable[..., set[Path]],
    tmp_path: Path,
) -> None:
    process = subprocess.Popen(
        [sys.executable, '-m', 'kapitsa_ros', 'experiment', '--rate', '1', '--bags', str(tmp_path / 'A'), '--json'],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={name: value for name, value in os.environ.items() if name != 'ROS_DOMAIN_ID'},
    )  # fmt: skip
    try:
        assert process.stderr is not None
        assert next(line for line in process.stderr if 'run 1 of 3' in line)
        nodes = processes_of(process.pid)
        shared = shared_memory_of(nodes.values())
        assert len(shared) == len(ROLE_NAMES)
        os.kill(nodes[role], signal.SIGKILL)
        out, err = process.communicate(timeout=180)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 1
    assert out == ''
    assert [line for line in err.splitlines() if line] == [f'kapitsa: error: {role} was killed by SIGKILL']
    assert not [pid for pid in nodes.values() if Path(f'/proc/{pid}').exists()]
    assert not [segment for segment in shared if segment.exists()]
    # A bag that is left does not pretend to be whole.
    for bag in (tmp_path / 'A').glob('*/metadata.yaml'):
        assert "complete: 'false'" in bag.read_text()


def test_a_node_that_is_asked_to_leave_ends_the_experiment_too(
    processes_of: Callable[[int], dict[str, int]], tmp_path: Path
) -> None:
    """It leaves with status 0, as it should; the others would wait for it for ever."""
    process = subprocess.Popen(
        [sys.executable, '-m', 'kapitsa_ros', 'experiment', '--rate', '5', '--bags', str(tmp_path / 'A')],
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        assert process.stderr is not None
        assert next(line for line in process.stderr if 'run 1 of 3' in line)
        nodes = processes_of(process.pid)
        os.kill(nodes['strobe'], signal.SIGTERM)
        _, err = process.communicate(timeout=180)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 1
    assert err.strip() == 'kapitsa: error: strobe was ended before the session was over'


def left_by_a_killed_node(domain: int) -> set[str]:
    with NodeGroup(['pendulum'], parameters(setup_of(Path())), domain) as nodes:
        assert nodes['pendulum'].wait_for_line('waiting for', PATIENCE)
        before = stale_segments()
        nodes['pendulum'].end(signal.SIGKILL)
        with pytest.raises(RigError, match='pendulum was killed'):
            nodes.wait(PATIENCE)
        return stale_segments() - before


def test_shared_memory_of_a_killed_node_is_found_and_removed(domain: int) -> None:
    """Another rig of this machine that begins or ends just then removes it, too."""
    left = next(filter(None, (left_by_a_killed_node(domain) for _ in range(5))), set())
    assert left
    remove_stale_segments()
    assert not left & stale_segments()


def test_where_locks_cannot_be_looked_up_every_segment_is_left(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(shared_memory, '_FOLDER', tmp_path)
    for name in ('fastrtps_0123456789abcdef', 'fastrtps_0123456789abcdef_el'):
        (tmp_path / name).touch()
        os.utime(tmp_path / name, (0, 0))
    monkeypatch.setattr(shared_memory, '_NEW', -1.0)
    with monkeypatch.context() as patch:
        patch.setattr(shared_memory, '_LOCKS', tmp_path / 'nowhere')
        remove_stale_segments()
    assert len(list(tmp_path.iterdir())) == 2
    remove_stale_segments()
    assert not list(tmp_path.iterdir())


def test_nothing_outlives_a_rig_that_is_killed(processes_of: Callable[[int], dict[str, int]], tmp_path: Path) -> None:
    command = [sys.executable, '-m', 'kapitsa_ros', 'experiment', '--rate', '1', '--bags', str(tmp_path)]
    environment = {name: value for name, value in os.environ.items() if name != 'ROS_DOMAIN_ID'}
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment)
    assert process.stderr is not None
    assert next(line for line in process.stderr if 'run 1 of 3' in line)
    watches = {name: os.pidfd_open(pid) for name, pid in processes_of(process.pid).items()}
    assert len(watches) == len(ROLE_NAMES) + 1
    process.kill()
    process.communicate()
    for name, watch in watches.items():
        assert select.select([watch], [], [], 10.0)[0], f'{name} still runs'
        os.close(watch)
    remove_stale_segments()  # those of the rig itself, which the next one would remove


def test_a_second_rig_in_a_domain_is_refused(kapitsa: Kapitsa, domain: int, tmp_path: Path) -> None:
    answer = kapitsa('experiment', '--bags', tmp_path, env={'ROS_DOMAIN_ID': str(domain)})
    assert answer.status == 1
    assert f'a rig runs in domain {domain} already' in answer.err


def test_a_second_node_of_a_role_is_refused(
    domain: int, observer: SessionMonitor, tmp_path: Path, eventually: Callable[[Callable[[], bool]], None]
) -> None:
    """The one that runs goes on."""
    with NodeGroup(ROLE_NAMES, parameters(setup_of(tmp_path, rate=1.0)), domain) as nodes:
        eventually(lambda: int(observer.progress.get('step', 0)) > 3)  # all have found one another
        with (
            NodeGroup(['pendulum'], parameters(setup_of(tmp_path)), domain) as second,
            pytest.raises(RigError, match=r'writes /pendulum/motion in domain .*: a rig is there .* ROS_DOMAIN_ID'),
        ):
            carry_out(second)
        before = observer.progress
        assert observer.wait_for_progress(PATIENCE) != before
        assert all(nodes[role].status() is None for role in ROLE_NAMES)


def test_a_node_of_its_role_on_another_machine_is_found_by_dds(domain: int, tmp_path: Path) -> None:
    """The stranger holds no lock of this machine."""
    with stranger_node('pendulum', domain) as stranger:
        stranger.create_publisher(message_class(MOTION.type), MOTION.name, STREAM)
        told = f'2 nodes write pendulum/motion in domain {domain}: a rig is there already'
        late = NodeGroup(['pendulum'], parameters(setup_of(tmp_path)), domain)
        with late, pytest.raises(RigError, match=told):
            carry_out(late)


def test_a_disk_that_takes_nothing(tmp_path: Path, domain: int) -> None:
    (tmp_path / 'A').write_text('a file where a folder should be')
    with (
        NodeGroup(ROLE_NAMES, parameters(setup_of(tmp_path / 'A')), domain) as nodes,
        pytest.raises(RigError, match=r'recorder .*/A cannot be written; give a folder'),
    ):
        carry_out(nodes)
