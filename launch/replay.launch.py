"""Recorded runs through the graph: player and analyser."""

from pathlib import Path

from launch.actions import (
    DeclareLaunchArgument,
    IncludeLaunchDescription,
    LogInfo,
    OpaqueFunction,
    SetEnvironmentVariable,
)
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from kapitsa_ros.recording.reader import runs_of
from kapitsa_ros.rig.environment import loopback
from kapitsa_ros.rig.launch_arguments import (
    NODE_ARGUMENTS,
    TRUTH_VALUES,
    executables,
    given_to_viewer,
    misspelt,
    node_options,
    replay_from,
)
from kapitsa_ros.rig.setup import REPLAY_NAMES
from kapitsa_ros.rig.viewers import VIEWERS
from launch import LaunchContext, LaunchDescription, LaunchDescriptionEntity

ARGUMENTS = {
    'bags': ('runs', 'folder of a run, or of several', None),
    'rate': ('1.0', 'simulated over wall seconds; 0: as fast as it can', None),
    'start': ('0.0', 'where to begin, s of the runs laid end to end', None),
    'end': ('', 'where to end, s; empty: the end', None),
    'loop': ('false', 'begin again at the end', TRUTH_VALUES),
    'start_paused': ('false', 'wait for the service player/resume', TRUTH_VALUES),
    'viewer': ('none', 'what shows the runs, if its package is installed', list(VIEWERS)),
    'namespace': NODE_ARGUMENTS['namespace'],
    'log_level': NODE_ARGUMENTS['log_level'],
    'composed': NODE_ARGUMENTS['composed'],
}


def nodes(context: LaunchContext) -> list[LaunchDescriptionEntity]:
    """Start the viewer, and both roles with the bags in the folder, in the order of their names."""
    arguments = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    values = replay_from(arguments)
    started: list[LaunchDescriptionEntity] = [
        Node(package='kapitsa_ros', **given)
        for given in executables(REPLAY_NAMES, arguments, node_options(arguments, context, values))
    ]
    if arguments['viewer'] != 'none':
        plant = runs_of([Path(values['bags'][0])])[0].run.plant
        given = given_to_viewer(arguments, plant, arguments['bags'])
        path = Path(__file__).with_name('viewer.launch.py')
        # First, so that nothing has started when its package is missing.
        started.insert(0, IncludeLaunchDescription(str(path), launch_arguments=given.items()))
    return started


def misspelt_arguments(context: LaunchContext) -> list[LaunchDescriptionEntity]:
    """Say which arguments were given that may be meant for others."""
    return [LogInfo(msg=line) for line in misspelt(context.launch_configurations, ARGUMENTS)]


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments and start the nodes."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=text, choices=choices)
        for name, (default, text, choices) in ARGUMENTS.items()
    ]
    environment = [SetEnvironmentVariable(name, value) for name, value in loopback().items()]
    functions = [OpaqueFunction(function=function) for function in (misspelt_arguments, nodes)]
    return LaunchDescription([*declared, *environment, *functions])
