"""Launch arguments made a rig's setup or the parameters of a replay; the end of a launch whose node has failed."""

from __future__ import annotations

import os
import re
from contextlib import contextmanager
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kapitsa_ros.configuration.assignments import parse_assignments
from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.playback_parameters import PlaybackParameters
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.rig_parameters import RigParameters
from kapitsa_ros.errors import OPTION, KapitsaError
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.recording.reader import runs_of
from kapitsa_ros.recording.storage.bag_files import is_bag
from kapitsa_ros.rig.errors import RigError, UsageError
from kapitsa_ros.rig.preflight import prepare
from kapitsa_ros.rig.setup import Replay, Setup, replay_parameters
from kapitsa_ros.ros.arguments import COMPOSED, PARENT_OPTION
from kapitsa_ros.ros.errors import SettingError
from kapitsa_ros.ros.params_file import read_params_file
from kapitsa_ros.schema import describe, description_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

PLANT_ARGUMENTS = {item.name: description_of(item) for item in describe(Plant)}
"""Launch arguments that stand for a parameter of the plant, and what they mean."""
TRUTH_VALUES = ['true', 'false', 'True', 'False']
"""As launch files and Python write them."""
NODE_ARGUMENTS: dict[str, tuple[str, str, list[str] | None]] = {
    'namespace': ('', 'of the nodes', None),
    'log_level': ('', 'of the nodes', ['', 'debug', 'info', 'warn', 'error', 'fatal']),
    'composed': ('false', 'all nodes in one process', TRUTH_VALUES),
}
"""Launch arguments of all nodes: default, meaning, choices."""
_OF_ONE_ROLE = (*PLANT_ARGUMENTS, 'protocol', 'rate', 'bags', 'compression')
_OF_ALL_ROLES = ('seed',)
"""Launch arguments that are parameters of nodes: of one role, or of several that all get the same."""
_NAMESPACE = re.compile(r'/|(/?[a-z_]\w*)(/[a-z_]\w*)*', re.ASCII | re.IGNORECASE)
"""What rcl takes; it would be said by each of the nodes, in its words."""


def rig_from(arguments: Mapping[str, str]) -> Setup:
    """Return the rig that the arguments of a launch describe, and its `params_file`, which goes before them.

    Raises
    ------
    UsageError
        An argument cannot be used.

    """
    arguments = {**arguments, **_arguments_in_file(arguments)}
    with _errors_in_launch_form():
        of_plant = {name: arguments[name] for name in PLANT_ARGUMENTS if arguments.get(name)}
        return Setup(
            plant=load_preset(arguments['preset'], parse_assignments(arguments['plant'].split()) | of_plant),
            instruments=load_instruments(arguments['instruments'], parse_assignments(arguments['instrument'].split())),
            protocol=arguments['protocol'],
            rate=_read('rate', arguments),
            seed=_read('seed', arguments),
            bags=Path(arguments['bags']).expanduser(),
            compression=arguments['compression'],
        )


def misspelt(given: Iterable[str], known: Collection[str]) -> list[str]:
    """Return in words which arguments of a launch are none of its own, but much like one.

    launch takes any name without a word. Those that are like none may be of a file that includes this one.
    """
    unknown = sorted(name for name in set(given) - set(known) if not name.startswith('ros_'))  # launch_ros keeps such
    likely = ((name, get_close_matches(name, known, n=1, cutoff=0.75)) for name in unknown)
    return [f'{name}:= is unknown, and not used: {close[0]}:= may be meant' for name, close in likely if close]


def make_ready(setup: Setup) -> None:
    """Make the folder for the bags of a rig: after all else that may be refused.

    Raises
    ------
    UsageError
        It cannot be written, or the rig not be started.

    """
    with _errors_in_launch_form():
        prepare(setup)


def node_options(arguments: Mapping[str, str], context: Any, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a `launch_ros.actions.Node` is given besides its executable.

    Parameters
    ----------
    arguments
        Of the launch: `namespace`, `log_level`, and `params_file` where it has one.
    context
        Of the launch.
    values
        Parameters of the node; those of the file go before them.

    Raises
    ------
    UsageError
        It is no params file, or no namespace.

    """
    namespace = arguments['namespace']
    if namespace and not _NAMESPACE.fullmatch(namespace):
        raise UsageError(f'namespace:={namespace!r}: give words of letters, digits and _ between /, as in lab/left')
    file = _params_file(arguments)
    level = arguments['log_level']
    # A node leaves when its launcher is gone, even killed. A prefix, such as a debugger, is a parent in between.
    prefixed = context.launch_configurations.get('launch-prefix')
    return {
        'namespace': namespace or None,
        'parameters': [dict(values), *([str(file)] if file else [])],
        'arguments': [] if prefixed else [PARENT_OPTION, str(os.getpid())],
        'ros_arguments': ['--log-level', level] if level else [],
        'output': 'screen',
        'on_exit': end_with_failed,
    }


def namespace_of(arguments: Mapping[str, str], context: Any) -> str:
    """Return the namespace of the nodes of a launch: its argument, below one that was pushed by who includes it."""
    pushed, given = context.launch_configurations.get('ros_namespace', ''), arguments['namespace']
    return given if given.startswith('/') else f'{pushed.rstrip("/")}/{given}'.rstrip('/')


def executables(roles: Sequence[str], arguments: Mapping[str, str], options: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return what each `launch_ros.actions.Node` is given, so that these roles run: one if the launch is `composed`.

    Parameters
    ----------
    roles
        Of the nodes.
    arguments
        Of the launch.
    options
        Of every node, from `node_options`.

    """
    if _is_true(arguments['composed']):  # without a name, which all would get
        return [{**options, 'executable': COMPOSED, 'arguments': [*options['arguments'], *roles]}]
    return [{**options, 'executable': role, 'name': role} for role in roles]


def replay_from(arguments: Mapping[str, str]) -> dict[str, Any]:
    """Return the parameters for a replay of the runs in a folder, in the order of their names, or of one run.

    Raises
    ------
    UsageError
        An argument cannot be used: no run is there, or one that cannot be read.

    """
    with _errors_in_launch_form():
        replay = Replay(
            rate=_read('rate', arguments),
            part=PlaybackParameters.of({name: arguments[name] for name in ('start', 'end') if arguments[name]}),
            loop=_is_true(arguments['loop']),
            start_paused=_is_true(arguments['start_paused']),
        )
        paths = runs_below(Path(arguments['bags']).expanduser())
        for bag in runs_of(paths):
            bag.refuse_gaps()
    return replay_parameters(paths, replay)


def given_to_viewer(arguments: Mapping[str, str], plant: Plant, bags: str = '') -> dict[str, str]:
    """Return every argument of viewer.launch.py: one that is not given it would take from the file that includes it.

    Parameters
    ----------
    arguments
        Of the launch that includes it: `viewer` and `namespace`.
    plant
        That is drawn.
    bags
        Folder of the run that is replayed, or of several.

    """
    return {
        'viewer': arguments['viewer'],
        'length': str(plant.length),
        'amplitude': str(plant.amplitude),
        'bags': bags,
        'namespace': arguments['namespace'],
    }


def drawn_from(arguments: Mapping[str, str]) -> tuple[Plant, list[str]]:
    """Return the plant that a viewer draws, and the folders of the runs that it replays, if any.

    Raises
    ------
    UsageError
        An argument cannot be used.

    """
    with _errors_in_launch_form():
        plant = Plant().replaced({name: arguments[name] for name in ('length', 'amplitude')})
        bags = runs_below(Path(arguments['bags']).expanduser()) if arguments['bags'] else []
    return plant, [str(path) for path in bags]


def runs_below(folder: Path) -> list[Path]:
    """Return the folders of the runs in a folder, in the order of their names, or itself where it is that of one.

    Raises
    ------
    UsageError
        No run is there.

    """
    paths = [folder] if is_bag(folder) else sorted(path for path in folder.glob('*/') if is_bag(path))
    if not paths:
        raise UsageError(
            f'{OPTION}: no run is there; give the folder of a run, or of several', option='bags', value=folder
        )
    return paths


def end_with_failed(event: Any, context: Any) -> None:
    """End the launch with status 1 when a node has failed; for `on_exit` of a `launch_ros.actions.Node`.

    Raises
    ------
    RigError
        The node of this `ProcessExited` event failed, and nobody had asked it to end.

    """
    if event.returncode and not context.is_shutdown:
        raise RigError(f'{event.process_name} has failed with status {event.returncode}: the other nodes are stopped')


def _is_true(argument: str) -> bool:
    return argument.lower() == 'true'


def _params_file(arguments: Mapping[str, str]) -> Path | None:
    given = arguments.get('params_file')
    return Path(given).expanduser() if given else None


def _arguments_in_file(arguments: Mapping[str, str]) -> dict[str, str]:
    """Return what nodes are given in the params file and a launch derives other things from, as launch arguments."""
    file = _params_file(arguments)
    if file is None:
        return {}
    try:
        parameters = read_params_file(file)
    except SettingError as error:
        raise UsageError(f'params_file:={error}') from error
    of_all = {name: value for node, given in parameters.items() if node == '/**' for name, value in given.items()}
    of_one = {name: value for given in parameters.values() for name, value in given.items()}
    return {
        name: str(given[name])
        for names, given in ((_OF_ALL_ROLES, of_all), (_OF_ONE_ROLE, of_one))
        for name in names
        if isinstance(given.get(name), str | float | int)  # all else is refused by the node
    }


def _read(name: str, arguments: Mapping[str, str]) -> Any:
    try:
        return getattr(RigParameters.of({name: arguments[name]}), name)
    except ConfigurationError as error:
        raise UsageError(f'{OPTION}: {error}', option=name, value=arguments[name]) from error


@contextmanager
def _errors_in_launch_form() -> Iterator[None]:
    """Name options in errors as launch files write them: `bags:=` for `--bags`."""
    try:
        yield
    except KapitsaError as error:
        raise UsageError(error.in_launch()) from error
