"""Recorded runs through the graph: player and analyser."""

from pathlib import Path

from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig.environment import loopback
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.rig.roster import REPLAY_ROLES, replay_parameters
from kapitsa_ros.rig.viewers import VIEWERS
from launch import LaunchContext, LaunchDescription, LaunchDescriptionEntity


def nodes(context: LaunchContext) -> list[LaunchDescriptionEntity]:
    """Start both with the bags below the folder, in the order of their names, and the viewer."""
    folder = Path(LaunchConfiguration('bags').perform(context))
    bags = sorted(path.parent for path in folder.glob('*/metadata.yaml'))
    if not bags:
        raise UsageError(f'bags:={folder}: there is no run in this folder')
    told = replay_parameters(bags, float(LaunchConfiguration('rate').perform(context)))
    started: list[LaunchDescriptionEntity] = [
        Node(package='kapitsa_ros', executable=role, name=role, parameters=[told], output='screen')
        for role in REPLAY_ROLES
    ]
    viewer = LaunchConfiguration('viewer').perform(context)
    if viewer != 'none':
        plant = RunBag(bags[0]).run.plant
        drawn = {'viewer': viewer, 'length': str(plant.length), 'amplitude': str(plant.amplitude)}
        path = Path(__file__).with_name('viewer.launch.py')
        # First, so that nothing has started when its package is missing.
        started.insert(0, IncludeLaunchDescription(str(path), launch_arguments=drawn.items()))
    return started


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments and start the nodes."""
    return LaunchDescription(
        [
            DeclareLaunchArgument('bags', default_value='runs', description='folder of the runs'),
            DeclareLaunchArgument(
                'rate', default_value='1.0', description='simulated over wall seconds; 0: as fast as it can'
            ),
            DeclareLaunchArgument(
                'viewer',
                default_value='none',
                description='what shows the runs, if its package is installed',
                choices=list(VIEWERS),
            ),
            *(SetEnvironmentVariable(name, value) for name, value in loopback().items()),
            OpaqueFunction(function=nodes),
        ]
    )
