"""What the launch files need besides launch itself: text made a set-up, a folder made runs, an end on a failure."""

from __future__ import annotations

import re
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kapitsa_ros.cli.options import RATE, SEED
from kapitsa_ros.physics.plant import load_preset
from kapitsa_ros.recording.errors import BagError
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
            plant=load_preset(said['preset']),
            instruments=said['instruments'],
            protocol=said['protocol'],
            rate=_read('rate', RATE, said),
            seed=_read('seed', SEED, said),
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
        rate = _read('rate', RATE, said)
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


def _read(name: str, kind: click.ParamType, said: Mapping[str, str]) -> Any:  # type: ignore[type-arg]
    try:
        return kind.convert(said[name], None, None)
    except click.BadParameter as error:
        raise UsageError(f'--{name} {said[name]}: {error.message}') from error


@contextmanager
def _in_words_of_launch() -> Iterator[None]:
    """Name an argument as it is written here: `bags:=` for `--bags`."""
    try:
        yield
    except (RigError, BagError, ValueError) as error:
        raise UsageError(re.sub(r'--([a-z]+)( (?=\S+: ))?', r'\1:=', str(error))) from error
