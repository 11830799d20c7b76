"""The laboratory: seven nodes that carry out a protocol and record it."""

from pathlib import Path

from launch.actions import IncludeLaunchDescription

from kapitsa_ros.instruments.settings import INSTRUMENT_SETS
from kapitsa_ros.physics.parameters import PRESETS
from kapitsa_ros.rig.launch_parts import describe, role_node
from kapitsa_ros.rig.launched import rig_from
from kapitsa_ros.rig.roster import parameters
from kapitsa_ros.rig.viewers import VIEWERS
from launch import LaunchDescription, LaunchDescriptionEntity

ARGUMENTS = {
    'preset': ('ideal', 'the plant', list(PRESETS)),
    'instruments': ('1997', 'how readings err', list(INSTRUMENT_SETS)),
    'protocol': ('1997', 'name of a shipped protocol, or a YAML file', None),
    'rate': ('1.0', 'simulated over wall seconds; 0: as fast as it can', None),
    'seed': ('1', 'of all chance', None),
    'bags': ('runs', 'folder in which each run gets a bag', None),
    'viewer': ('none', 'what shows the rig, if its package is installed', list(VIEWERS)),
}


def start(said: dict[str, str]) -> list[LaunchDescriptionEntity]:
    """Start the viewer and the roles of the roster."""
    setup = rig_from(said)
    told = parameters(setup)
    plant = setup.plant
    drawn = {'viewer': said['viewer'], 'length': str(plant.length), 'amplitude': str(plant.amplitude)}
    path = Path(__file__).with_name('viewer.launch.py')
    # The viewer first, so that nothing has started when its package is missing.
    return [
        IncludeLaunchDescription(str(path), launch_arguments=drawn.items()),
        *(role_node(role, told) for role in setup.roles),
    ]


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments and start the nodes."""
    return describe(ARGUMENTS, start)
