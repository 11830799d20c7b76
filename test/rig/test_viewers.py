"""Viewers: what is published for them, the model, and layouts that name what exists."""

import json
import math
import re
import sys
import time
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
import rclpy
import yaml
from rclpy.clock import JumpThreshold
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import ReliabilityPolicy
from rosbags.typesys import Stores, get_typestore
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.configuration.urdf import MASS, urdf
from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.network import registry
from kapitsa_ros.network.cdr import read_step_id, stamp_of
from kapitsa_ros.network.registry import MOTION, PIVOT, RECORDED
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.operator.command import Command
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig import Rig
from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.setup import REPLAY_NAMES, Replay, replay_parameters
from kapitsa_ros.rig.viewers import VIEWERS, programs
from kapitsa_ros.ros.diagnostics import progress_message
from kapitsa_ros.ros.joint_state_publisher import JOINTS
from kapitsa_ros.ros.qos import LATCHED, VIEW, message_class
from kapitsa_ros.ros.real_time_pacer import RealTimePacer

pytestmark = pytest.mark.xdist_group('viewers')
ROOT = Path(__file__).parents[2]
CONFIG = ROOT / 'config' / 'viewers'
SHIPPED = sorted(path.parent for path in (ROOT / 'bags').glob('*/metadata.yaml'))
NUMBERED = {f'/{topic.name}': topic.type for topic in RECORDED}
TOPICS = NUMBERED | {
    '/joint_states': 'sensor_msgs/msg/JointState',
    '/clock': 'rosgraph_msgs/msg/Clock',
    '/diagnostics': 'diagnostic_msgs/msg/DiagnosticArray',
}
PATIENCE = 180.0


# What is published.


@dataclass
class Viewer:
    """Somebody who looks at a rig."""

    node: Node
    executor: SingleThreadedExecutor
    states: list[JointState] = field(default_factory=list)
    models: list[str] = field(default_factory=list)
    jumps: list[int] = field(default_factory=list)
    """Of its own clock, forth or back, s."""
    ticks: list[int] = field(default_factory=list)
    """When a timer of a second has rung, on that clock."""
    clocks: list[int] = field(default_factory=list)

    def watch(self, seen_enough: Callable[[], bool]) -> None:
        deadline = time.monotonic() + PATIENCE
        while not seen_enough():
            assert time.monotonic() < deadline
            self.executor.spin_once(timeout_sec=0.1)


@contextmanager
def viewer_in(domain: int) -> Iterator[Viewer]:
    context = Context()
    with on_loopback():
        rclpy.init(context=context, domain_id=domain)
        node = Node('viewer', context=context, parameter_overrides=[Parameter('use_sim_time', value=True)])
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    viewer = Viewer(node, executor)
    node.create_subscription(JointState, 'joint_states', viewer.states.append, VIEW)
    node.create_subscription(String, 'robot_description', lambda message: viewer.models.append(message.data), LATCHED)
    node.create_timer(1.0, lambda: viewer.ticks.append(node.get_clock().now().nanoseconds))
    far = JumpThreshold(min_forward=Duration(seconds=100), min_backward=Duration(nanoseconds=-1))
    clock = node.get_clock()
    listening = clock.create_jump_callback(far, post_callback=lambda jump: viewer.jumps.append(jump.delta.nanoseconds))
    node.create_subscription(Clock, '/clock', lambda message: viewer.clocks.append(nanoseconds(message.clock)), VIEW)
    try:
        yield viewer
    finally:
        listening.unregister()  # not later: its callback would outlive the clock
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()


def nanoseconds(stamp: Any) -> int:
    return stamp.sec * SECOND + stamp.nanosec


def recorded_states(*bags: Path) -> dict[int, tuple[list[float], list[float]]]:
    """Return positions and velocities of pivot and pendulum by stamp; of two blocks that meet, the end of the first."""
    states: dict[int, tuple[list[float], list[float]]] = {}
    for bag in map(RunBag, bags):
        steps: dict[int, dict[str, bytes]] = {}
        for topic, _, raw in bag.raw(PIVOT.name, MOTION.name):
            steps.setdefault(stamp_of(raw), {})[topic] = raw
        for start, messages in sorted(steps.items()):
            if any(read_step_id(raw).end for raw in messages.values()):
                continue
            pair = [registry.PIVOT.decode(messages[name]) for name in (PIVOT.name, MOTION.name)]
            for index in range(pair[0].position.size):
                stamp = start + index * round(pair[0].period * SECOND)
                state = [[float(getattr(one, name)[index]) for one in pair] for name in ('position', 'rate')]
                states.setdefault(stamp, (state[0], state[1]))
    assert len(states) > 1000
    return states


def agree(states: list[JointState], *bags: Path) -> None:
    """Assert that what was shown is what was recorded, at growing stamps; the last again where no other comes."""
    recorded = recorded_states(*bags)
    stamps = [nanoseconds(state.header.stamp) for state in states]
    assert stamps == sorted(stamps)
    for stamp, state in zip(stamps, states, strict=True):
        assert list(state.name) == JOINTS
        assert (list(state.position), list(state.velocity)) == recorded[stamp]


def test_joint_states_are_the_recorded_motion(tmp_path: Path) -> None:
    with Rig(rate=1.0, bags=tmp_path) as rig, viewer_in(rig.domain) as viewer:
        rig.request_speed(2500)
        rig.release(0.12)
        viewer.watch(lambda: any(abs(state.position[0]) > 0.006 for state in viewer.states))
        count = len(viewer.states)
        viewer.watch(lambda: len(viewer.states) >= count + 50)
        (end,) = viewer.node.get_publishers_info_by_topic('/joint_states')
        assert end.node_name == 'pendulum'
        assert end.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT  # nobody who looks holds the rig up
        (model,) = viewer.models
        assert model == urdf(Plant())
        rig.reset()
        viewer.watch(lambda: viewer.clocks[-1] > 2 * 86_400 * SECOND + 2 * SECOND)
    # The clock of whoever uses simulated time leaps from 0 to run 1 and on to run 2, and no timer rings for a day.
    assert viewer.clocks == sorted(viewer.clocks)
    assert [round(jump / SECOND / 86_400) for jump in viewer.jumps] == [1, 1]
    assert len(viewer.ticks) < (viewer.clocks[-1] - viewer.clocks[0]) / SECOND - 86_390
    agree([state for state in viewer.states if state.header.stamp.sec < 2 * 86_400], next(tmp_path.glob('run_01_*')))


def test_a_replay_shows_the_recorded_motion() -> None:
    with reserved_domain() as domain, viewer_in(domain) as viewer:
        told = replay_parameters(SHIPPED[:1], Replay(rate=1.0))
        with NodeGroup(REPLAY_NAMES, told, domain):
            viewer.watch(lambda: len(viewer.states) >= 10 and len(viewer.clocks) >= 10)
    agree(viewer.states, SHIPPED[0])
    assert viewer.models == [urdf(RunBag(SHIPPED[0]).run.plant)]
    assert viewer.clocks == sorted(set(viewer.clocks))
    assert viewer.clocks[0] >= 86_400 * SECOND


def said_twice(told: list[Any]) -> bool:
    return len(told) > 1 and told[-1] == told[-2]


def test_who_joins_while_time_stands_still_is_told_the_time_and_shown_the_rod(tmp_path: Path) -> None:
    with Rig(rate=1.0, bags=tmp_path) as rig:
        rig.request_speed(2500)
        rig.release(0.12)
        rig.wait_for('pendulum/motion')
        rig.pause()
        with viewer_in(rig.domain) as viewer:
            viewer.watch(lambda: said_twice(viewer.states) and said_twice(viewer.clocks))
            rig.resume()
            count = len(viewer.states)
            viewer.watch(lambda: len(viewer.states) > count + 50)
    agree(viewer.states, next(tmp_path.glob('run_01_*')))


def test_a_replay_that_waits_for_its_start_tells_the_time() -> None:
    with reserved_domain() as domain, viewer_in(domain) as viewer:
        told = replay_parameters(SHIPPED[:1], Replay(rate=1.0, start_paused=True))
        with NodeGroup(REPLAY_NAMES, told, domain):
            viewer.watch(lambda: said_twice(viewer.clocks))
    assert set(viewer.clocks) == {86_400 * SECOND}


# The model.


@pytest.fixture(params=[{}, {'length': 0.4, 'amplitude': 0.03}], ids=['1997', 'another'])
def plant(request: pytest.FixtureRequest) -> Plant:
    return load_preset('ideal', request.param)


def shipped_links() -> set[str]:
    return {link.attrib['name'] for link in parsed('kapitsa.urdf').findall('link')}


def parsed(name: str) -> ET.Element:
    return ET.fromstring((CONFIG / name).read_text(encoding='utf-8'))


def joints(model: ET.Element) -> dict[str, ET.Element]:
    return {joint.attrib['name']: joint for joint in model.iter('joint')}


def limits(joint: ET.Element) -> dict[str, float]:
    found = joint.find('limit')
    assert found is not None
    return {name: float(value) for name, value in found.attrib.items()}


def test_the_model_is_one_tree_and_moves_at_the_joints_of_the_topic(plant: Plant) -> None:
    model = ET.fromstring(urdf(plant))
    links = {link.attrib['name'] for link in model.findall('link')}
    ends = [
        (joint.find('parent').attrib['link'], joint.find('child').attrib['link'])  # type: ignore[union-attr]
        for joint in joints(model).values()
    ]
    children = [child for _, child in ends]
    assert len(children) == len(set(children))
    assert links - set(children) == {'jigsaw'}
    assert {link for pair in ends for link in pair} == links
    assert [name for name, joint in joints(model).items() if joint.attrib['type'] != 'fixed'] == JOINTS
    assert {joints(model)[name].attrib['type'] for name in JOINTS} == {'prismatic', 'revolute'}
    materials = {material.attrib['name'] for material in model.findall('material')}
    assert {used.attrib['name'] for used in model.findall('link/visual/material')} == materials


@pytest.mark.parametrize('bag', SHIPPED, ids=lambda path: path.name)
def test_the_limits_of_the_model_hold_a_recorded_motion(bag: Path) -> None:
    model = ET.fromstring(urdf(RunBag(bag).run.plant))
    for position, velocity in recorded_states(bag).values():
        for name, value, rate in zip(JOINTS, position, velocity, strict=True):
            bounds = limits(joints(model)[name])
            assert bounds['lower'] <= value <= bounds['upper']
            assert abs(rate) <= bounds['velocity']


@pytest.fixture
def body(plant: Plant) -> Any:
    """The model as MuJoCo's own URDF parser reads it, with its data."""
    mujoco = pytest.importorskip('mujoco')
    keep = '<mujoco><compiler fusestatic="false" discardvisual="false"/></mujoco></robot>'
    model = mujoco.MjModel.from_xml_string(urdf(plant).replace('</robot>', keep))
    model.opt.gravity[:] = (0.0, 0.0, -plant.gravity)
    return mujoco, model, mujoco.MjData(model)


def test_the_tip_of_the_model_is_where_physics_has_it(plant: Plant, body: Any) -> None:
    mujoco, model, data = body
    for height, angle in ((0.0, 0.0), (0.7, 0.12), (-1.0, -0.4), (1.0, 1.5)):
        data.joint('pivot').qpos = height * plant.amplitude
        data.joint('pendulum').qpos = angle
        mujoco.mj_kinematics(model, data)
        wanted = [plant.length * math.sin(angle), 0.0, height * plant.amplitude + plant.length * math.cos(angle)]
        assert data.body('tip').xpos == pytest.approx(wanted, abs=1e-9)


def test_the_model_moves_as_the_plant_does(plant: Plant, body: Any) -> None:
    """θ″ = k (g + y″) sin θ needs no torque at the pivot (report, eq. 1)."""
    mujoco, model, data = body
    for angle, lift in ((0.1, 0.0), (-0.7, 300.0), (1.2, -500.0)):
        data.joint('pendulum').qpos = angle
        data.joint('pivot').qacc = lift
        data.joint('pendulum').qacc = plant.k * (plant.gravity + lift) * math.sin(angle)
        mujoco.mj_inverse(model, data)
        scale = MASS * (plant.gravity + lift) * plant.length / 2
        assert data.qfrc_inverse[model.joint('pendulum').dofadr[0]] / scale == pytest.approx(0.0, abs=1e-6)


def test_the_shipped_model_is_what_the_command_prints(kapitsa: Callable[..., Any]) -> None:
    answer = kapitsa('urdf')
    assert answer.status == 0
    assert answer.out == (CONFIG / 'kapitsa.urdf').read_text(encoding='utf-8')
    assert kapitsa('urdf', '--length', '12in').out == urdf(Plant(length=0.3048))


# Layouts.


def field_type(topic: str, path: str) -> str:
    """Return the ROS type of a field of a topic; KeyError where it does not exist.

    `path` is as in `points[:].positions[0]`: arrays have an index.
    """
    kind = TOPICS[topic].replace('/msg/', '/')
    for part in path.split('.'):
        match = re.fullmatch(r'(\w+)(\[(?:\d+|:)\])?', part)
        assert match, f'{topic}.{path}'
        package, name = kind.split('/')
        kind = message_class(f'{package}/msg/{name}').get_fields_and_field_types()[match[1]]
        array = re.fullmatch(r'sequence<(.+)>', kind)
        assert bool(array) == bool(match[2]), f'{topic}.{path}: {part} is a {kind}'
        kind = array[1] if array else kind
    return kind


def foxglove(name: str) -> dict[str, Any]:
    return json.loads((CONFIG / name).read_text(encoding='utf-8'))


def plots(layout: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield title, topic and the rest of each path that is plotted."""
    for panel in layout['configById'].values():
        for path in panel.get('paths', ()):
            topic, rest = re.fullmatch(r'(/[\w/]+)(.*)', path['value']).groups()  # type: ignore[union-attr]
            yield panel['title'], topic, rest


LAYOUTS = ('foxglove.json', 'foxglove_replay.json', 'foxglove_bag.json')
EXPORTED = 'foxglove_joint_states.json'  # its paths: test_other_readers.py


@pytest.mark.parametrize('name', LAYOUTS)
def test_foxglove_plots_fields_that_exist(name: str) -> None:
    paths = list(plots(foxglove(name)))
    assert paths
    for title, topic, rest in paths:
        condition, path = re.fullmatch(r'(?:\{(.*)\})?\.(.*)', rest).groups()  # type: ignore[union-attr]
        assert field_type(topic, path) in {'double', 'builtin_interfaces/Time'}
        if condition:
            compared, value = condition.split('==')
            assert field_type(topic, compared) == 'string'
            assert value == f'"timed {load_protocol("1997").swings} swings"'
        if topic == '/joint_states':
            assert path == f'position[{JOINTS.index(title.split(",")[0].lower())}]'


@pytest.mark.parametrize('name', [*LAYOUTS, EXPORTED])
def test_foxglove_lays_out_every_panel_once(name: str) -> None:
    layout = foxglove(name)

    def leaves(tree: Any) -> Iterator[str]:
        if isinstance(tree, str):
            yield tree
        else:
            assert tree['direction'] in {'row', 'column'}
            yield from leaves(tree['first'])
            yield from leaves(tree['second'])

    assert sorted(leaves(layout['layout'])) == sorted(layout['configById'])


def test_a_replay_has_the_layout_of_a_rig_at_the_times_of_its_own() -> None:
    text = (CONFIG / 'foxglove.json').read_text(encoding='utf-8')
    replayed = (CONFIG / 'foxglove_replay.json').read_text(encoding='utf-8')
    assert replayed == text.replace('"headerStamp"', '"receiveTime"')
    assert replayed != text


def test_foxglove_shows_bags_what_is_in_them() -> None:
    document = yaml.safe_load((SHIPPED[0] / 'metadata.yaml').read_text(encoding='utf-8'))
    held = {
        '/' + entry['topic_metadata']['name'].removeprefix('/')
        for entry in document['rosbag2_bagfile_information']['topics_with_message_count']
    }
    assert {topic for _, topic, _ in plots(foxglove('foxglove_bag.json'))} <= held


def test_foxglove_shows_the_model_and_the_diagnostics() -> None:
    panels = foxglove('foxglove.json')['configById']
    links = shipped_links()
    scene = panels['3D!rig']
    assert {scene['followTf'], scene['fixedFrame']} <= links
    assert list(scene['topics']) == ['/robot_description']
    assert panels['DiagnosticSummary!rig']['topicToRender'] == '/diagnostics'


def series() -> set[str]:
    """Return what PlotJuggler calls the curves of messages such as the rig publishes.

    A joint state becomes TOPIC/JOINT/FIELD, a diagnostic value TOPIC/HARDWARE/NAME/KEY.
    """
    store = get_typestore(Stores.ROS2_JAZZY)
    kind = 'sensor_msgs/msg/JointState'
    step_id = StepId(1, 0)
    messages = {
        '/operator/command': store.deserialize_cdr(registry.COMMAND.encode(0, step_id, Command(200.0, 0.1)), kind),
        '/strobe/reading': store.deserialize_cdr(
            registry.STROBE_READING.encode(0, step_id, StrobeReading(time=0.0, speed=200.0)), kind
        ),
        '/joint_states': JointState(name=JOINTS, position=[0.0, 0.0], velocity=[0.0, 0.0]),
    }
    names = {
        f'{topic}/{joint}/{column}'
        for topic, message in messages.items()
        for column in ('position', 'velocity')
        for joint, _ in zip(message.name, getattr(message, column), strict=False)
    }
    (status,) = progress_message('jigsaw', step_id, 0, RealTimePacer(1.0)).status
    return names | {f'/diagnostics/{status.hardware_id}/{status.name}/{pair.key}' for pair in status.values}


def test_plotjuggler_plots_curves_that_exist_of_topics_it_subscribes_to() -> None:
    layout = parsed('plotjuggler.xml')
    curves = {curve.attrib['name'] for curve in layout.iter('curve')}
    assert len(curves) >= 5
    assert curves <= series()
    subscribed = {topic.attrib['name'] for topic in layout.iter('topic')}
    assert subscribed <= set(TOPICS)
    assert subscribed == {topic for topic in TOPICS if any(curve.startswith(f'{topic}/') for curve in curves)}
    streamer = layout.find('previouslyLoaded_Streamer')
    plugin = layout.find('Plugins/plugin')
    assert streamer is not None
    assert plugin is not None
    assert streamer.attrib['name'] == plugin.attrib['ID']


def test_rviz_shows_the_model_in_its_frame() -> None:
    manager = yaml.safe_load((CONFIG / 'kapitsa.rviz').read_text(encoding='utf-8'))['Visualization Manager']
    links = shipped_links()
    displays = {display['Class'].split('/')[1]: display for display in manager['Displays']}
    assert manager['Global Options']['Fixed Frame'] in links
    assert displays['Grid']['Reference Frame'] in links
    assert manager['Views']['Current']['Target Frame'] in links
    assert set(displays['TF']['Frames']) - {'All Enabled'} <= links
    assert displays['RobotModel']['Description Topic']['Value'] == '/robot_description'
    # robot_state_publisher latches it
    assert displays['RobotModel']['Description Topic']['Durability Policy'] == 'Transient Local'


# What launch files start.


def test_foxglove_is_served_by_our_own_where_its_bridge_is_not_installed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip('foxglove')
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(tmp_path))
    (live,) = programs('foxglove', Plant())
    assert (live.package, live.executable, live.parameters) == ('kapitsa_ros', 'foxglove_server', {'port': 8765})
    (replayed,) = programs('foxglove', Plant(), ['runs/run_01'])
    assert replayed.parameters == {'port': 8765, 'bags': ['runs/run_01']}
    index = tmp_path / 'share' / 'ament_index' / 'resource_index' / 'packages'
    index.mkdir(parents=True)
    for package in ('robot_state_publisher', 'foxglove_bridge'):
        (index / package).touch()
    assert [program.package for program in programs('foxglove', Plant())] == [
        'robot_state_publisher',
        'foxglove_bridge',
    ]


@pytest.mark.parametrize('viewer', [name for name in VIEWERS if name != 'none'])
def test_a_viewer_that_is_not_installed_is_named_with_its_package(
    viewer: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, 'foxglove', None)
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(tmp_path))
    monkeypatch.setenv('ROS_DISTRO', 'jazzy')
    with pytest.raises(UsageError, match=rf'^viewer {viewer} needs .*: sudo apt install ros-jazzy-[a-z0-9-]+( |;|$)'):
        programs(viewer, Plant())


def test_installed_viewers_are_started_with_files_that_exist(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    index = tmp_path / 'share' / 'ament_index' / 'resource_index' / 'packages'
    index.mkdir(parents=True)
    for package in ('robot_state_publisher', 'rviz2', 'plotjuggler', 'plotjuggler_ros', 'foxglove_bridge'):
        (index / package).touch()
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(tmp_path))
    plant = Plant(length=0.3)
    started = {viewer: {program.package: program for program in programs(viewer, plant)} for viewer in VIEWERS}
    assert {viewer: sorted(names) for viewer, names in started.items()} == {
        'none': [],
        'rviz': ['robot_state_publisher', 'rviz2'],
        'plotjuggler': ['plotjuggler'],
        'foxglove': ['foxglove_bridge', 'robot_state_publisher'],
    }
    assert started['rviz']['robot_state_publisher'].parameters['robot_description'] == urdf(plant)
    for program in (started['rviz']['rviz2'], started['plotjuggler']['plotjuggler']):
        assert Path(program.arguments[-1]).is_file()
    expressions = started['foxglove']['foxglove_bridge'].parameters['best_effort_qos_topic_whitelist']
    for namespace in ('', '/lab', '/hall/lab'):  # it may not hold any rig up
        assert all(any(re.fullmatch(one, namespace + topic) for one in expressions) for topic in NUMBERED)
    # In a namespace RViz has to look for the model where robot_state_publisher has it.
    manager = yaml.safe_load((CONFIG / 'kapitsa.rviz').read_text(encoding='utf-8'))['Visualization Manager']
    (model,) = (one for one in manager['Displays'] if one['Class'].endswith('/RobotModel'))
    assert started['rviz']['rviz2'].remappings == ((model['Description Topic']['Value'], 'robot_description'),)
    assert programs('rviz', plant, namespace='/lab') == programs('rviz', plant)
    with pytest.raises(UsageError, match=r'^viewer plotjuggler: .* not of /lab: start plotjuggler by itself'):
        programs('plotjuggler', plant, namespace='/lab')


def test_an_unknown_viewer_is_refused() -> None:
    with pytest.raises(UsageError, match=r'gazebo.*rviz'):
        programs('gazebo', Plant())
