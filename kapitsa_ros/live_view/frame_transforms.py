"""Where the links of the model are: `/tf` from `robot_description` and `joint_states`, where nobody else publishes it.

robot_state_publisher does the same, and is not on PyPI.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from rclpy._rclpy_pybind11 import RCLError  # it has no public type
from scipy.spatial.transform import Rotation
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.network.typestore import definition_of, new_message, new_time, serialise
from kapitsa_ros.ros.qos import LATCHED, VIEW
from kapitsa_ros.ros.rclpy_errors import first_line

if TYPE_CHECKING:
    from collections.abc import Mapping

    from foxglove import Channel
    from numpy.typing import NDArray
    from rclpy.subscription import Subscription

    from kapitsa_ros.live_view.foxglove_server import FoxgloveServer
    from kapitsa_ros.live_view.view_clock import ViewClock
    from kapitsa_ros.ros.process_node import ProcessNode

TOPIC = '/tf'
_TYPE = 'tf2_msgs/msg/TFMessage'
_LONGEST = 1_000_000
"""Characters of a model."""


class Joint(NamedTuple):
    """A joint of a URDF."""

    name: str
    parent: str
    child: str
    kind: str
    origin: NDArray[np.float64]
    """m, shape (3,)."""
    turn: Rotation
    """Of the child against its parent where the joint is at 0."""
    axis: NDArray[np.float64]
    """Of length 1, in the frame of the joint."""

    def place(self, position: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return translation, m, and rotation, as a quaternion x, y, z, w, of the child in its parent's frame."""
        if self.kind == 'prismatic':
            return self.origin + self.turn.apply(position * self.axis), self.turn.as_quat()
        if self.kind == 'fixed':
            return self.origin, self.turn.as_quat()
        return self.origin, (self.turn * Rotation.from_rotvec(position * self.axis)).as_quat()


def joints_of(urdf: str) -> list[Joint]:
    """Return the joints of a model.

    Raises
    ------
    ValueError
        It is no URDF.

    """
    if len(urdf) > _LONGEST or '<!ENTITY' in urdf:
        raise ValueError('a model of such a kind is not read')
    try:
        model = ET.fromstring(urdf)  # noqa: S314  # without entities, and short
        return [_joint(element) for element in model.findall('joint')]
    except (ET.ParseError, KeyError) as error:
        raise ValueError(f'no URDF: {error}') from error


def _joint(element: ET.Element) -> Joint:
    def numbers(tag: str, name: str, default: str) -> NDArray[np.float64]:
        found = element.find(tag)
        values = np.array((default if found is None else found.get(name, default)).split(), dtype=float)
        if values.shape != (3,):
            raise ValueError(f'{name} of a joint has {values.size} numbers')
        if not np.isfinite(values).all():
            raise ValueError(f'{name} of a joint is not finite')
        return values

    def link(tag: str) -> str:
        found = element.find(tag)
        return '' if found is None else found.attrib['link']

    axis = numbers('axis', 'xyz', '1 0 0')
    return Joint(
        name=element.attrib['name'],
        parent=link('parent'),
        child=link('child'),
        kind=element.attrib['type'],
        origin=numbers('origin', 'xyz', '0 0 0'),
        turn=Rotation.from_euler('xyz', numbers('origin', 'rpy', '0 0 0')),
        axis=axis / (np.linalg.norm(axis) or 1.0),
    )


def encode_transforms(joints: list[Joint], positions: Mapping[str, float], stamp_ns: int) -> bytes:
    """Return a tf2_msgs/TFMessage with the frames of all links whose joint's position is known, or fixed."""
    transforms = []
    for joint in joints:
        if joint.kind != 'fixed' and joint.name not in positions:
            continue
        shift, turn = joint.place(positions.get(joint.name, 0.0))
        transforms.append(
            new_message(
                'geometry_msgs/msg/TransformStamped',
                new_message('std_msgs/msg/Header', new_time(stamp_ns), joint.parent),
                joint.child,
                new_message(
                    'geometry_msgs/msg/Transform',
                    new_message('geometry_msgs/msg/Vector3', *map(float, shift)),
                    new_message('geometry_msgs/msg/Quaternion', *map(float, turn)),
                ),
            )
        )
    return serialise(_TYPE, transforms)


class FrameTransforms:
    """The channel `/tf`, filled while a client wants it.

    Parameters
    ----------
    node
        Who listens to model and joints: those of its own namespace.
    server
        Where the channel is.
    clock
        Tells when a message is shown.

    """

    def __init__(self, node: ProcessNode, server: FoxgloveServer, clock: ViewClock) -> None:
        self._node, self._server, self._clock = node, server, clock
        self._channel: Channel | None = None
        self._joints: list[Joint] = []
        self._subscriptions: list[Subscription] = []

    def look(self) -> list[str]:
        """Make the channel, unless somebody publishes the topic; return the topics that are made here."""
        is_others = self._node.count_publishers(TOPIC) > 0
        if self._channel is None and not is_others:
            self._channel = self._server.channel(TOPIC, _TYPE, definition_of(_TYPE))
        elif self._channel is not None and is_others:
            self._channel.close()
            self._channel = None
        self.tend()
        return [] if is_others else [TOPIC]

    def tend(self) -> None:
        """Listen while a client wants to know."""
        is_wanted = self._channel is not None and self._channel.has_sinks()
        if is_wanted and not self._subscriptions:
            try:
                self._subscribe()
            except RCLError as error:  # somebody publishes another type there
                self._node.refuse(first_line(error))
        elif self._subscriptions and not is_wanted:
            for subscription in self._subscriptions:
                self._node.destroy_subscription(subscription)
            self._subscriptions = []

    def _subscribe(self) -> None:
        subscribe = self._node.create_subscription
        self._subscriptions.append(subscribe(String, 'robot_description', self._take_model, LATCHED))
        self._subscriptions.append(subscribe(JointState, 'joint_states', self._take_state, VIEW))

    def _take_model(self, message: String) -> None:
        self._joints = joints_of(message.data)

    def _take_state(self, message: JointState) -> None:
        if self._channel is None:
            return
        stamp_ns = message.header.stamp.sec * SECOND + message.header.stamp.nanosec
        time_ns = self._clock.shown(stamp_ns)
        positions = dict(zip(message.name, message.position, strict=False))
        self._channel.log(encode_transforms(self._joints, positions, time_ns), log_time=time_ns)
