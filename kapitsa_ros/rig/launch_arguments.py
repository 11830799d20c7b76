"""What the launch files need besides launch itself: text made a set-up, a folder made runs, an end on a failure."""

from __future__ import annotations

import re
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kapitsa_ros.configuration.assignments import parse_assignments
from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.rig_parameters import RigParameters
from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig.errors import RigError, UsageError
from kapitsa_ros.rig.preflight import prepare
from kapitsa_ros.rig.setup import Setup, replay_parameters

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_RECORDED = ('metadata.yaml', '*.mcap', '*.db3')
"""One of these is in the folder of a run, also where its recorder was killed."""


def rig_from(said: Mapping[str, str]) -> Setup:
    """Return the rig that the arguments of a launch describe, its folder of bags made.

    Raises
    ------
    UsageError
        An argument cannot be used; nothing has been started.

    """
    with _in_words_of_launch():
        setup = Setup(
            plant=load_preset(said['preset'], parse_assignments(said['plant'].split())),
            instruments=load_instruments(said['instruments'], parse_assignments(said['instrument'].split())),
            protocol=said['protocol'],
            rate=_read('rate', said),
            seed=_read('seed', said),
            bags=Path(said['bags']).expanduser(),
        )
        prepare(setup)
    return setup


def replay_from(said: Mapping[str, str]) -> dict[str, Any]:
    """Return the parameters for a replay of the runs in a folder, in the order of their names, or of one run.

    Raises
    ------
    UsageError
        An argument cannot be used: no run is there, or one that cannot be read.

    """
    folder = Path(said['bags']).expanduser()
    with _in_words_of_launch():
        rate = _read('rate', said)
        paths = [folder] if _is_run(folder) else sorted(path for path in folder.glob('*/') if _is_run(path))
        if not paths:
            raise UsageError(f'--bags {folder}: no run is there; give the folder of a run, or of several')
        for path in paths:
            RunBag(path)
    return replay_parameters(paths, rate)


def end_with_failed(event: Any, context: Any) -> None:
    """End the launch with status 1 when a node has failed; for `on_exit` of a `launch_ros.actions.Node`.

    Raises
    ------
    RigError
        The node of this `ProcessExited` event failed, and nobody had asked it to end.

    """
    if event.returncode and not context.is_shutdown:
        raise RigError(f'{event.process_name} has failed with status {event.returncode}: the other nodes are stopped')


def _is_run(folder: Path) -> bool:
    return any(path.is_file() for pattern in _RECORDED for path in folder.glob(pattern))


def _read(name: str, said: Mapping[str, str]) -> Any:
    try:
        return getattr(RigParameters.of({name: said[name]}), name)
    except ConfigurationError as error:
        raise UsageError(f'--{name} {said[name]}: {error}') from error


@contextmanager
def _in_words_of_launch() -> Iterator[None]:
    """Name an argument as it is written here: `bags:=` for `--bags`."""
    try:
        yield
    except KapitsaError as error:
        raise UsageError(re.sub(r'--([a-z]+)( (?=\S+: ))?', r'\1:=', str(error))) from error
