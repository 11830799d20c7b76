"""Whole sessions: an experiment from protocol to analysis, and its replay from bags."""

from __future__ import annotations

import json
import logging
import os
from contextlib import AbstractContextManager, nullcontext, suppress
from typing import TYPE_CHECKING, Any

from kapitsa_ros.address_space import OF_A_RIG, refuse_small_address_space
from kapitsa_ros.analysis.assumptions import DEFAULT_ASSUMPTIONS
from kapitsa_ros.analysis.experiment import reduce_runs
from kapitsa_ros.analysis.results import experiment_values, run_values
from kapitsa_ros.configuration.playback_parameters import PlaybackParameters
from kapitsa_ros.laboratory.bag_analysis import analyse_bags, origin, recorded_values
from kapitsa_ros.network.registry import PLAYER, REPLAY_NAMES, SESSION_MONITOR
from kapitsa_ros.recording.naming import run_number
from kapitsa_ros.recording.playback import Playback
from kapitsa_ros.recording.reader import runs_of
from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.rig.errors import RigError, UsageError
from kapitsa_ros.rig.formation import Formation
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.preflight import prepare, refuse_unspeakable
from kapitsa_ros.rig.setup import parameters, replay_parameters
from kapitsa_ros.rig.shared_memory import removing_stale_segments
from kapitsa_ros.ros.session_monitor import SessionMonitor

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.rig.setup import Replay, Setup
    from kapitsa_ros.ros.time_control_client import TimeControlClient

    Progress = Callable[[dict[str, str]], None]

_LOG = logging.getLogger(__name__)
WATCH_PERIOD = 0.5
"""Seconds between two looks at the clock while all goes well; a death is noticed at once."""


LEAVING = 1.0
"""Seconds after which a node that ended without an error, before the session was over, is missing."""


def run_experiment(
    setup: Setup, on_progress: Progress, assumptions: Assumptions = DEFAULT_ASSUMPTIONS
) -> dict[str, Any]:
    """Start the graph, carry out the protocol, record a bag a run, and analyse the bags.

    The analyser has done that already, from the messages that the bags hold; where it took other things for granted,
    somebody else may have said its result, or a bag lacks something or says something else of its run, the bags are
    analysed.

    Raises
    ------
    UsageError
        The folder for the bags cannot be written, or the jigsaw cannot turn so fast.
    BagError
        A run of that name is there already.
    RigError
        A node died.
    NodeError
        A second writer has said results of the analyser, too.

    """
    was_there = os.path.isdir(setup.bags)  # noqa: PTH112  # what cannot be looked at is refused with a reason below
    prepare(setup)
    others = set(setup.bags.glob('run_*'))
    try:
        monitor, reset = watch(setup.roles, parameters(setup), on_progress, composed=setup.composed)
    except BaseException:
        if not was_there:
            with suppress(OSError):  # there are runs in it
                setup.bags.rmdir()
        raise
    # Those of the protocol, and of runs that somebody reset.
    paths = sorted(set(setup.bags.glob('run_*')) - others, key=run_number)
    made: dict[str, Any] = {'protocol': setup.protocol, 'realtime_factor': monitor.realtime_factor}
    if reset:
        made['reset_runs'] = reset
    bags = runs_of(paths) if assumptions == DEFAULT_ASSUMPTIONS and monitor.has_one_source else []
    are_whole = bags and all(bag.complete and not bag.defects for bag in bags)
    if are_whole and monitor.runs == [run_values(bag.run) for bag in bags]:
        runs = [recorded_values(bag) | of_run for bag, of_run in zip(bags, monitor.runs, strict=True)]
        return {'runs': runs} | monitor.experiment | origin([bag.run for bag in bags]) | made
    return analyse_bags(paths, assumptions) | made


def replay_bags(
    paths: Sequence[Path],
    replay: Replay,
    on_progress: Progress,
    on_result: Callable[[dict[str, Any]], None] | None = None,
    steered: Callable[[TimeControlClient], AbstractContextManager[None]] | None = None,
) -> dict[str, Any]:
    """Play recorded runs through the graph, let the analyser analyse them as they come, and compare with the bags.

    Parameters
    ----------
    paths
        Folders of the runs.
    replay
        How they are played.
    on_progress
        Called with the values of each progress report.
    on_result
        Called with what is returned as soon as it is there: before a loop goes on.
    steered
        Given a client of the player's time control, returns the context in which the replay is watched.

    Raises
    ------
    BagError
        A path is no run.
    UsageError
        The runs are over before the part that is to be played begins.
    AddressSpaceError
        The shell allows less memory than nodes take.
    RigError
        A node died, or the result is not that of the bags.
    NodeError
        A second writer has said results of the analyser, too.

    """
    refuse_small_address_space(OF_A_RIG)
    bags = runs_of(paths)
    for bag in bags:
        bag.refuse_gaps()
    whole = [bag.run for bag in bags]
    experiment = reduce_runs(whole)  # what does not belong together is refused before anything starts
    playback = Playback(bags)
    duration = playback.duration
    if replay.part.start >= duration:
        raise UsageError(f'--start is {replay.part.start:g} s: the runs last {duration:g} s together')

    is_whole = replay.part == PlaybackParameters()
    runs = whole if is_whole else playback.runs(replay.part.end)
    of_runs = [run_values(run) for run in runs]
    of_all = experiment_values(experiment if is_whole else reduce_runs(runs))
    made = {} if is_whole else {'played_s': [replay.part.start, min(replay.part.end, duration)]}

    def values(monitor: SessionMonitor) -> dict[str, Any]:
        _refuse_others_results(monitor, of_runs, of_all)
        told = [recorded_values(bag) | of_run for bag, of_run in zip(bags, of_runs, strict=False)]
        return {'runs': told} | of_all | origin(whole) | {'realtime_factor': monitor.realtime_factor} | made

    def tell(monitor: SessionMonitor) -> None:
        if on_result is not None:
            on_result(values(monitor))

    def attended(monitor: SessionMonitor) -> AbstractContextManager[None]:
        return nullcontext() if steered is None else steered(monitor.time_control(PLAYER.name))

    told = replay_parameters(paths, replay)
    refuse_unspeakable(told)
    return values(watch(REPLAY_NAMES, told, on_progress, tell, attended, composed=replay.composed)[0])


def _refuse_others_results(
    monitor: SessionMonitor, of_runs: Sequence[Mapping[str, Any]], of_all: Mapping[str, Any]
) -> None:
    """Refuse a session whose results, as they came over the topic of the analyser, are not those of its bags."""
    if [monitor.runs, monitor.experiment] != json.loads(json.dumps([of_runs, of_all])):
        raise RigError(
            'analyser/result is not what the bags say: somebody else writes in this domain; '
            'choose another ROS_DOMAIN_ID, or stop it'
        )


def watch(
    roles: Sequence[str],
    values: dict[str, Any],
    on_progress: Progress,
    on_end: Callable[[SessionMonitor], None] = lambda _: None,
    attended: Callable[[SessionMonitor], AbstractContextManager[None]] = lambda _: nullcontext(),
    *,
    composed: bool = False,
) -> tuple[SessionMonitor, list[int]]:
    """Run a graph until its nodes have left; return its monitor, and which runs were reset.

    Tell when its session is over.
    """
    told = False
    with removing_stale_segments(), reserved_domain() as domain:
        with on_loopback():
            monitor = SessionMonitor(domain, on_progress)
        with (
            monitor,
            NodeGroup(
                roles, values | {'expect': [*values['expect'], SESSION_MONITOR.name]}, domain, composed=composed
            ) as nodes,
            attended(monitor),
        ):
            formation, warned = Formation(nodes), set[str]()
            while not nodes.wait(WATCH_PERIOD):
                monitor.check()
                if not monitor.progress:
                    formation.check()
                for line in set(nodes.held_up()) - warned:
                    warned.add(line)
                    _LOG.warning('kapitsa: warning: %s', line)
                if not monitor.session_over:
                    nodes.refuse_leavers(LEAVING)
                elif not told and monitor.is_complete:
                    on_end(monitor)
                    told = True
            monitor.wait_for_end()
            if not told:
                on_end(monitor)
            for line in nodes.refusals():
                _LOG.warning('kapitsa: warning: %s', line)
            reset = nodes.reset_runs()
            if reset:
                _LOG.warning('kapitsa: warning: %s', _reset_text(reset))
    return monitor, reset


def _reset_text(runs: Sequence[int]) -> str:
    which = f'run {runs[0]} was' if len(runs) == 1 else f'runs {", ".join(map(str, runs))} were'
    return (
        f'{which} cut short by a call of the service jigsaw/reset: what was timed by then counts, and later runs have '
        'other numbers, and with them other chance, than without'
    )
