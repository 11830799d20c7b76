"""Programs that show the rig, all of them optional: what launch files start for `viewer:=NAME`."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from ament_index_python.packages import PackageNotFoundError, get_package_prefix

from kapitsa_ros.configuration.urdf import urdf
from kapitsa_ros.network.registry import RECORDED
from kapitsa_ros.resources import resource_path
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.ros.arguments import FOXGLOVE_PORT, FOXGLOVE_SERVER

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.physics.plant import Plant

PACKAGE = 'kapitsa_ros'
VIEWERS = ('none', 'rviz', 'plotjuggler', 'foxglove')


@dataclass(frozen=True)
class Program:
    """A ROS executable."""

    package: str
    executable: str
    arguments: tuple[str, ...] = ()
    parameters: dict[str, Any] = field(default_factory=dict)
    remappings: tuple[tuple[str, str], ...] = ()


def programs(viewer: str, plant: Plant, bags: Sequence[str] = (), namespace: str = '') -> list[Program]:
    """Return what to start so that a viewer shows a rig with this plant.

    Foxglove is served by its bridge, or by our own server (`live_view`) where that is not installed.

    Parameters
    ----------
    viewer
        Which.
    plant
        That is drawn.
    bags
        Folders of the runs, where it is a replay.
    namespace
        Of the rig.

    Raises
    ------
    UsageError
        There is no such viewer, a package it needs is not installed, or it sees no rig in a namespace.

    """
    if viewer not in VIEWERS:
        raise UsageError(f'viewer {viewer!r} is unknown: choose one of {", ".join(VIEWERS)}')
    needed = {
        'none': (),
        'rviz': ('robot_state_publisher', 'rviz2'),
        'plotjuggler': ('plotjuggler', 'plotjuggler_ros'),
        'foxglove': ('robot_state_publisher', 'foxglove_bridge'),
    }[viewer]
    if viewer == 'foxglove' and find_spec('foxglove') and not _is_installed('foxglove_bridge'):
        return [
            Program(PACKAGE, FOXGLOVE_SERVER, parameters={'port': FOXGLOVE_PORT} | ({'bags': [*bags]} if bags else {}))
        ]
    missing = [package for package in needed if not _is_installed(package)]
    if missing:
        names = ' '.join(
            f'ros-{os.environ.get("ROS_DISTRO", "jazzy")}-{package.replace("_", "-")}' for package in missing
        )
        instead = '; or pip install "kapitsa_ros[foxglove]"' if viewer == 'foxglove' else ''
        raise UsageError(f'viewer {viewer} needs {" and ".join(missing)}: sudo apt install {names}{instead}')
    if viewer == 'rviz':
        config = str(resource_path('config', 'viewers', 'kapitsa.rviz'))
        # The file names the topic as it is without a namespace.
        remappings = (('/robot_description', 'robot_description'),)
        return [_state_publisher(plant), Program('rviz2', 'rviz2', ('-d', config), {'use_sim_time': True}, remappings)]
    if viewer == 'plotjuggler':
        if namespace.strip('/'):
            raise UsageError(
                f'viewer plotjuggler: its layout has the topics of a rig without a namespace, not of {namespace}: '
                'start plotjuggler by itself and choose them'
            )
        layout = str(resource_path('config', 'viewers', 'plotjuggler.xml'))
        return [Program('plotjuggler', 'plotjuggler', ('--layout', layout))]
    if viewer == 'foxglove':
        return [_state_publisher(plant), _bridge()]
    return []


def _state_publisher(plant: Plant) -> Program:
    """Return the node that turns joint states into frames; it takes each that comes, however slow the rig."""
    return Program(
        'robot_state_publisher',
        'robot_state_publisher',
        parameters={'robot_description': urdf(plant), 'publish_frequency': 1000.0, 'use_sim_time': True},
    )


def _bridge() -> Program:
    """Return Foxglove's bridge: open to this machine alone, and of no weight to the rig when it falls behind."""
    return Program(
        'foxglove_bridge',
        'foxglove_bridge',
        parameters={
            'address': '127.0.0.1',
            'port': FOXGLOVE_PORT,
            'use_sim_time': True,
            # Regular expressions, for a rig in a namespace too.
            'best_effort_qos_topic_whitelist': [f'(/.*)?/{topic.name}' for topic in RECORDED],
        },
    )


def _is_installed(package: str) -> bool:
    try:
        get_package_prefix(package)
    except PackageNotFoundError:
        return False
    return True
