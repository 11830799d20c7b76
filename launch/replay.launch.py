"""Recorded runs through the graph: player and analyser."""

from pathlib import Path

from launch.actions import DeclareLaunchArgument, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from kapitsa_ros.rig.environment import loopback
from kapitsa_ros.rig.roster import REPLAY_ROLES, replay_parameters
from launch import LaunchContext, LaunchDescription


def nodes(context: LaunchContext) -> list[Node]:
    """Start both with the bags below the folder, in the order of their names."""
    folder = Path(LaunchConfiguration('bags').perform(context))
    bags = sorted(path.parent for path in folder.glob('*/metadata.yaml'))
    told = replay_parameters(bags, float(LaunchConfiguration('rate').perform(context)))
    return [
        Node(package='kapitsa_ros', executable=role, name=role, parameters=[told], output='screen')
        for role in REPLAY_ROLES
    ]


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments and start the nodes."""
    return LaunchDescription(
        [
            DeclareLaunchArgument('bags', default_value='runs', description='folder of the runs'),
            DeclareLaunchArgument(
                'rate', default_value='1.0', description='simulated over wall seconds; 0: as fast as it can'
            ),
            *(SetEnvironmentVariable(name, value) for name, value in loopback().items()),
            OpaqueFunction(function=nodes),
        ]
    )
