"""The laboratory: seven nodes that carry out a protocol and record it."""

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

from kapitsa_ros.recording.writer import COMPRESSIONS
from kapitsa_ros.rig.environment import loopback
from kapitsa_ros.rig.launch_arguments import (
    NODE_ARGUMENTS,
    PLANT_ARGUMENTS,
    executables,
    given_to_viewer,
    make_ready,
    misspelt,
    namespace_of,
    node_options,
    rig_from,
)
from kapitsa_ros.rig.setup import parameters
from kapitsa_ros.rig.viewers import VIEWERS, programs
from launch import LaunchContext, LaunchDescription, LaunchDescriptionEntity

ARGUMENTS = {
    'preset': ('ideal', 'the plant: name of a shipped preset, or a YAML file', None),
    'plant': ('', 'its parameters that differ, as in "length=9.75in coulomb=0.3"', None),
    'instruments': ('1997', 'how readings err: name of a shipped set, or a YAML file', None),
    'instrument': ('', 'their parameters that differ, as in "reaction_time=0.2 dial_error=0.01"', None),
    'protocol': ('1997', 'name of a shipped protocol, or a YAML file', None),
    'rate': ('1.0', 'simulated over wall seconds; 0: as fast as it can', None),
    'seed': ('1', 'of all chance', None),
    'bags': ('runs', 'folder in which each run gets a bag', None),
    'compression': ('zstd', 'of the chunks in the bags', list(COMPRESSIONS)),
    'viewer': ('none', 'what shows the rig, if its package is installed', list(VIEWERS)),
    'params_file': ('', 'parameters of nodes that go before all others', None),
    'namespace': NODE_ARGUMENTS['namespace'],
    'log_level': NODE_ARGUMENTS['log_level'],
    'composed': NODE_ARGUMENTS['composed'],
}
OF_PLANT = {name: ('', f'{meaning}; of the preset where not given', None) for name, meaning in PLANT_ARGUMENTS.items()}


def nodes(context: LaunchContext) -> list[LaunchDescriptionEntity]:
    """Start the viewer and the roles of the roster with what the arguments say."""
    arguments = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS | OF_PLANT}
    setup = rig_from(arguments)
    options = node_options(arguments, context, parameters(setup))
    started: list[LaunchDescriptionEntity] = [
        Node(package='kapitsa_ros', **given) for given in executables(setup.roles, arguments, options)
    ]
    if arguments['viewer'] != 'none':
        path = Path(__file__).with_name('viewer.launch.py')
        given = given_to_viewer(arguments, setup.plant)
        # Nothing is made or started where its package is missing.
        programs(arguments['viewer'], setup.plant, namespace=namespace_of(arguments, context))
        started.append(IncludeLaunchDescription(str(path), launch_arguments=given.items()))
    make_ready(setup)
    return started


def misspelt_arguments(context: LaunchContext) -> list[LaunchDescriptionEntity]:
    """Say which arguments were given that may be meant for others."""
    return [LogInfo(msg=line) for line in misspelt(context.launch_configurations, ARGUMENTS | OF_PLANT)]


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments and start the nodes."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=text, choices=choices)
        for name, (default, text, choices) in (ARGUMENTS | OF_PLANT).items()
    ]
    environment = [SetEnvironmentVariable(name, value) for name, value in loopback().items()]
    functions = [OpaqueFunction(function=function) for function in (misspelt_arguments, nodes)]
    return LaunchDescription([*declared, *environment, *functions])
