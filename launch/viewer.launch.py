"""A viewer for a rig that runs here, or that another launch file starts."""

from launch.actions import DeclareLaunchArgument, LogInfo, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.resources import resource_path
from kapitsa_ros.rig.environment import loopback
from kapitsa_ros.rig.launch_arguments import NODE_ARGUMENTS, drawn_from, namespace_of, node_options
from kapitsa_ros.rig.viewers import PACKAGE, VIEWERS, Program, programs
from kapitsa_ros.ros.arguments import FOXGLOVE_PORT
from launch import LaunchContext, LaunchDescription, LaunchDescriptionEntity

PLANT = Plant()
ARGUMENTS = {
    'viewer': ('rviz', 'what shows the rig', list(VIEWERS)),
    'length': (str(PLANT.length), 'of the rod that is drawn, m', None),
    'amplitude': (str(PLANT.amplitude), 'half the stroke of the pivot that is drawn, m', None),
    'bags': ('', 'folder of the run that is replayed, or of several; empty: it is no replay', None),
    'namespace': NODE_ARGUMENTS['namespace'],
}


def as_node(program: Program, arguments: dict[str, str], context: LaunchContext) -> Node:
    """Return the action that starts a program."""
    if program.package == PACKAGE:
        given = node_options(arguments | {'log_level': ''}, context, program.parameters)
        return Node(package=PACKAGE, executable=program.executable, **given)
    return Node(
        package=program.package,
        executable=program.executable,
        arguments=list(program.arguments),
        namespace=arguments['namespace'] or None,
        parameters=[program.parameters] if program.parameters else None,
        remappings=list(program.remappings),
        output='screen',
    )


def nodes(context: LaunchContext) -> list[LaunchDescriptionEntity]:
    """Start the viewer and what it needs, or say which package is missing."""
    arguments = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    plant, bags = drawn_from(arguments)
    wanted = programs(arguments['viewer'], plant, bags, namespace_of(arguments, context))
    started: list[LaunchDescriptionEntity] = [as_node(program, arguments, context) for program in wanted]
    if arguments['viewer'] == 'foxglove':
        is_played_back = bool(bags) and wanted[0].package == PACKAGE
        layout = resource_path('config', 'viewers', 'foxglove_replay.json' if is_played_back else 'foxglove.json')
        started.append(
            LogInfo(msg=f'Foxglove: open a connection to ws://127.0.0.1:{FOXGLOVE_PORT} and import the layout {layout}')
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
