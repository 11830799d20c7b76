"""The main job and its repetition from bags: run the protocol, record, analyse."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from kapitsa_ros.analysis.experiment import reduce_runs
from kapitsa_ros.nodes.observer import Observer
from kapitsa_ros.physics.pivot import MAX_SPEED
from kapitsa_ros.recording.naming import refuse_existing, run_name
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.rig.offline import analyse_bags, recorded_values
from kapitsa_ros.rig.processes import Nodes
from kapitsa_ros.rig.roster import REPLAY_ROLES, parameters, replay_parameters
from kapitsa_ros.rig.segments import no_dead_segments
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from kapitsa_ros.rig.roster import Setup

    Progress = Callable[[dict[str, str]], None]

WATCH_PERIOD = 0.5
"""Seconds between two looks at the clock while all goes well; a death is noticed at once."""


LEAVING = 1.0
"""Seconds after which a node that ended without an error, before the session was over, is missing."""


def run_experiment(setup: Setup, on_progress: Progress) -> dict[str, Any]:
    """Start the graph, carry out the protocol, record a bag a run, and analyse the bags.

    Raises
    ------
    UsageError
        The folder for the bags cannot be written, or the jigsaw cannot turn so fast.
    BagError
        A run of that name is there already.
    RigError
        A node died.

    """
    protocol = setup.carried_out()
    for speed in protocol.speeds:
        if speed > MAX_SPEED:
            raise UsageError(
                f'--protocol wants {speed / RPM:.0f} RPM: the jigsaw does {MAX_SPEED / RPM:.0f} RPM at most'
            )
    refuse_existing(setup.bags, protocol.speeds)
    make_writable(setup.bags)
    seen = _watch(setup.roles, parameters(setup), on_progress)
    bags = [setup.bags / run_name(number, speed) for number, speed in enumerate(protocol.speeds, start=1)]
    return analyse_bags(bags) | {'realtime_factor': float(seen.progress['realtime_factor'])}


def replay_bags(paths: Sequence[Path], rate: float, on_progress: Progress) -> dict[str, Any]:
    """Play recorded runs through the graph, and let the analyser analyse them as they come.

    Raises
    ------
    BagError
        A path is no run.
    RigError
        A node died.

    """
    bags = [RunBag(path) for path in paths]
    reduce_runs([bag.run for bag in bags])  # what does not belong together is refused before anything starts
    seen: Observer = _watch(REPLAY_ROLES, replay_parameters(paths, rate), on_progress)
    runs = [recorded_values(bag) | values for bag, values in zip(bags, seen.runs, strict=True)]
    values: dict[str, Any] = {'runs': runs} | seen.experiment
    return values | {'realtime_factor': float(seen.progress['realtime_factor'])}


def _watch(roles: Sequence[str], told: dict[str, Any], on_progress: Progress) -> Observer:
    """Run a graph until its session is over, and return what was seen of it."""
    with no_dead_segments(), reserved_domain() as domain:
        with on_loopback():
            observer = Observer(domain, on_progress)
        with observer as seen, Nodes(roles, told | {'expect': [*told['expect'], 'observer']}, domain) as nodes:
            while not nodes.wait(WATCH_PERIOD):
                if not seen.session_over:
                    nodes.refuse_leavers(LEAVING)
            seen.wait_for_end()
    return seen


def make_writable(folder: Path) -> None:
    """Make the folder for the bags.

    Raises
    ------
    UsageError
        It cannot be made, or not be written.

    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(
            f'--bags {folder}: cannot be made ({error.strerror}); give a folder you can write to'
        ) from error
    if not os.access(folder, os.W_OK | os.X_OK):
        raise UsageError(f'--bags {folder}: cannot be written; give a folder you can write to')
