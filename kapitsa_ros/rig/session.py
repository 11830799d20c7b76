"""Whole sessions: an experiment from protocol to analysis, and its replay from bags."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.analysis.experiment import reduce_runs
from kapitsa_ros.laboratory.bag_analysis import analyse_bags, origin, recorded_values
from kapitsa_ros.network.registry import SESSION_MONITOR
from kapitsa_ros.recording.naming import run_number
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.preflight import prepare
from kapitsa_ros.rig.setup import REPLAY_NAMES, parameters, replay_parameters
from kapitsa_ros.rig.shared_memory import removing_stale_segments
from kapitsa_ros.ros.session_monitor import SessionMonitor

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from kapitsa_ros.rig.setup import Setup

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
    prepare(setup)
    others = set(setup.bags.glob('run_*'))
    monitor = _watch(setup.roles, parameters(setup), on_progress)
    # Those of the protocol, and of runs that somebody reset.
    bags = sorted(set(setup.bags.glob('run_*')) - others, key=run_number)
    made = {'protocol': setup.protocol, 'realtime_factor': float(monitor.progress['realtime_factor'])}
    return analyse_bags(bags) | made


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
    monitor: SessionMonitor = _watch(REPLAY_NAMES, replay_parameters(paths, rate), on_progress)
    runs = [recorded_values(bag) | values for bag, values in zip(bags, monitor.runs, strict=True)]
    values: dict[str, Any] = {'runs': runs} | monitor.experiment | origin(bags[0].run)
    return values | {'realtime_factor': float(monitor.progress['realtime_factor'])}


def _watch(roles: Sequence[str], values: dict[str, Any], on_progress: Progress) -> SessionMonitor:
    """Run a graph until its session is over, and return its monitor."""
    with removing_stale_segments(), reserved_domain() as domain:
        with on_loopback():
            monitor = SessionMonitor(domain, on_progress)
        with (
            monitor,
            NodeGroup(roles, values | {'expect': [*values['expect'], SESSION_MONITOR.name]}, domain) as nodes,
        ):
            while not nodes.wait(WATCH_PERIOD):
                monitor.check()
                if not monitor.session_over:
                    nodes.refuse_leavers(LEAVING)
            monitor.wait_for_end()
    return monitor
