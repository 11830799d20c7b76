"""A viewer for a rig that runs here, or that another launch file starts."""

from launch.actions import DeclareLaunchArgument, LogInfo, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.resources import resource_path
from kapitsa_ros.rig.environment import loopback
from kapitsa_ros.rig.viewers import VIEWERS, Program, programs
from launch import LaunchContext, LaunchDescription, LaunchDescriptionEntity

PLANT = Plant()
ARGUMENTS = {
    'viewer': ('rviz', 'what shows the rig', list(VIEWERS)),
    'length': (str(PLANT.length), 'of the rod that is drawn, m', None),
    'amplitude': (str(PLANT.amplitude), 'half the stroke of the pivot that is drawn, m', None),
}


def as_node(program: Program) -> Node:
    """Return the action that starts a program."""
    return Node(
        package=program.package,
        executable=program.executable,
        arguments=list(program.arguments),
        parameters=[program.parameters] if program.parameters else None,
        output='screen',
    )


def nodes(context: LaunchContext) -> list[LaunchDescriptionEntity]:
    """Start the viewer and what it needs, or say which package is missing."""
    arguments = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    plant = Plant(length=float(arguments['length']), amplitude=float(arguments['amplitude']))
    started: list[LaunchDescriptionEntity] = [as_node(program) for program in programs(arguments['viewer'], plant)]
    if arguments['viewer'] == 'foxglove':
        layout = resource_path('config', 'viewers', 'foxglove.json')
        started.append(
            LogInfo(msg=f'Foxglove: open a connection to ws://127.0.0.1:8765 and import the layout {layout}')
        )
    return started


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments and start the viewer."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=text, choices=choices)
        for name, (default, text, choices) in ARGUMENTS.items()
    ]
    environment = [SetEnvironmentVariable(name, value) for name, value in loopback().items()]
    return LaunchDescription([*declared, *environment, OpaqueFunction(function=nodes)])
