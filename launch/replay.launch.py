"""Recorded runs through the graph: player and analyser."""

from pathlib import Path

from launch.actions import IncludeLaunchDescription

from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig.launch_parts import describe, role_node
from kapitsa_ros.rig.launched import replay_from
from kapitsa_ros.rig.roster import REPLAY_ROLES
from kapitsa_ros.rig.viewers import VIEWERS
from launch import LaunchDescription, LaunchDescriptionEntity

ARGUMENTS = {
    'bags': ('runs', 'folder of a run, or of several', None),
    'rate': ('1.0', 'simulated over wall seconds; 0: as fast as it can', None),
    'viewer': ('none', 'what shows the runs, if its package is installed', list(VIEWERS)),
}


def start(said: dict[str, str]) -> list[LaunchDescriptionEntity]:
    """Start the viewer, and both roles with the bags in the folder, in the order of their names."""
    told = replay_from(said)
    plant = RunBag(Path(told['bags'][0])).run.plant
    drawn = {'viewer': said['viewer'], 'length': str(plant.length), 'amplitude': str(plant.amplitude)}
    path = Path(__file__).with_name('viewer.launch.py')
    # The viewer first, so that nothing has started when its package is missing.
    return [
        IncludeLaunchDescription(str(path), launch_arguments=drawn.items()),
        *(role_node(role, told) for role in REPLAY_ROLES),
    ]


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments and start the nodes."""
    return describe(ARGUMENTS, start)
