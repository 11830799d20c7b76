"""All nodes in one process: the same bags, and as much of the rest as one process allows."""

import logging
import os
import select
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import kapitsa_ros as kr
from kapitsa_ros.analysis.assumptions import DEFAULT_ASSUMPTIONS
from kapitsa_ros.configuration.step_parameters import StepParameters
from kapitsa_ros.laboratory.bag_analysis import analyse_bags
from kapitsa_ros.laboratory.verification import verify_run
from kapitsa_ros.network.registry import ROLE_NAMES
from kapitsa_ros.nodes.__main__ import run_node
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig import Rig, RigError
from kapitsa_ros.rig.environment import node_environment
from kapitsa_ros.rig.launch_arguments import executables
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.session import replay_bags
from kapitsa_ros.rig.setup import Replay, Setup, parameters
from kapitsa_ros.ros.session_monitor import SessionMonitor

PATIENCE = 180.0
pytestmark = pytest.mark.xdist_group('processes')


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob('*')) if path.is_file()}


def test_bags_and_results_are_those_of_seven_processes(
    recorded: tuple[Path, dict[str, Any]], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    folder, values = recorded
    assumed = {'play_probability': 0.0}  # which the analyser does not know of
    found = kr.experiment('ideal', seed=1, bags=tmp_path / 'A', composed=True, assumptions=assumed)
    assert files(tmp_path / 'A') == files(folder)
    analysed = analyse_bags(sorted(folder.iterdir()), replace(DEFAULT_ASSUMPTIONS, **assumed))
    assert found.values['omega_crit_interval_rpm'] == analysed['omega_crit_interval_rpm']
    assert found.values['assumptions'] != values['assumptions']
    first = sorted(folder.iterdir())[:1]
    with caplog.at_level(logging.WARNING):
        again = replay_bags(first, Replay(composed=True), lambda _: None)
    assert not caplog.messages  # nothing was refused
    assert again['runs'][0]['period_s'] == values['runs'][0]['period_s']


def test_longer_steps_are_as_good_and_take_fewer_messages(tmp_path: Path) -> None:
    with Rig(bags=tmp_path, composed=True, steps=StepParameters(step=0.4, in_flight=1)) as rig:
        rig.request_speed(2500)
        rig.wait_for('jigsaw/pivot', lambda pivot: pivot.position.size == 401, timeout=PATIENCE)
        rig.release(0.1)
        rig.wait_for('pendulum/motion', lambda motion: motion.position[-1] < 0, PATIENCE)
        rig.reset()
        rig.wait_for('pendulum/motion', timeout=PATIENCE)  # of the next run: the bag of this one is complete
    bag = RunBag(min(tmp_path.iterdir()))
    assert bag.complete
    assert bag.motion.angle.size == 1 + 400 * (sum(1 for _ in bag.raw('pendulum/motion')) - 1)  # and its end
    assert verify_run(bag).identical


def test_a_rig_in_one_process_is_worked_as_any_and_named_where_it_is_killed(
    shared_memory_of: Callable[..., set[Path]], tmp_path: Path
) -> None:
    with Rig(instruments='ideal', bags=tmp_path, composed=True) as rig:
        assert len({process.pid for process in rig.processes.values()}) == 1
        assert rig.processes.keys() == set(ROLE_NAMES)
        rig.request_speed(2500)
        rig.release(0.1)
        assert rig.wait_for('stopwatch/reading', timeout=PATIENCE).displayed > 0.5
        rig.pause()
        rig.step(3)
        rig.resume()
        rig.reset()
        assert RunBag(next(tmp_path.glob('run_01_*'))).motion.gaps == 0
        shared = shared_memory_of([rig.processes['jigsaw'].pid])
        assert shared
        rig.processes['strobe'].end(signal.SIGKILL)
        with pytest.raises(RigError, match=f'the process of {", ".join(ROLE_NAMES)} was killed by SIGKILL'):
            rig.wait_for('stopwatch/reading', timeout=600)
    assert not [segment for segment in shared if segment.exists()]


def test_a_signal_ends_all_in_order(domain: int, observer: SessionMonitor, tmp_path: Path) -> None:
    with NodeGroup(ROLE_NAMES, parameters(Setup(bags=tmp_path, rate=1.0)), domain, composed=True) as nodes:
        for _ in range(2):  # of the first step, and of a later one
            observer.wait_for_progress(PATIENCE)
        process = nodes['recorder']
        process.end(signal.SIGTERM)
        assert select.select([process.sentinel], [], [], PATIENCE)[0]
        assert (process.status(), 'Traceback' in process.last_error_lines()) == (0, False)
        assert process.wait_for_line('holds a run that was interrupted', PATIENCE)


def test_the_node_that_cannot_be_made_is_named(domain: int) -> None:
    with NodeGroup(['strobe', 'pendulum'], {'length': -1.0}, domain, composed=True) as nodes:
        assert select.select([nodes['strobe'].sentinel], [], [], PATIENCE)[0]
        with pytest.raises(RigError, match=r'^pendulum died with status 2: parameter length'):
            nodes.check()


BUG = """
import sys
import kapitsa_ros.nodes.pendulum as pendulum
from kapitsa_ros.nodes.__main__ import main

class Broken(pendulum.PendulumNode):
    def poll(self):
        raise RuntimeError('a bug')

pendulum.create = Broken
sys.exit(main(['composed', 'strobe', 'pendulum']))
"""


def test_the_node_that_has_a_bug_is_named(domain: int) -> None:
    command = [sys.executable, '-c', BUG]
    done = subprocess.run(
        command, env=node_environment(domain), capture_output=True, text=True, timeout=180, check=False
    )
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == "pendulum: error: RuntimeError('a bug')"


def test_what_a_launch_starts() -> None:
    options = {'arguments': ['--parent-pid', '7'], 'output': 'screen'}
    alone = executables(('jigsaw', 'strobe'), {'composed': 'false'}, options)
    assert [(one['executable'], one['name'], one['arguments'][-1]) for one in alone] == [
        ('jigsaw', 'jigsaw', '7'), ('strobe', 'strobe', '7'),
    ]  # fmt: skip
    [together] = executables(('jigsaw', 'strobe'), {'composed': 'true'}, options)
    assert (together['executable'], 'name' in together) == ('composed', False)
    # As launch_ros puts it: a namespace and parameters are of all nodes.
    given = ['--ros-args', '-r', '__ns:=/lab', '-p', 'clearance:=-1.0']
    command = [sys.executable, '-m', 'kapitsa_ros.nodes', 'composed', *together['arguments'], 'pendulum', *given]
    command[command.index('7')] = str(os.getpid())
    done = subprocess.run(command, env=node_environment(99), capture_output=True, text=True, timeout=180, check=False)
    assert done.returncode == 2
    assert 'pendulum: error: parameter clearance' in done.stderr
    assert '[lab.jigsaw]: joins domain' in done.stderr


def test_composed_nodes_have_roles(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_node(['composed', 'strobe', 'pendulam']) == 2
    assert "node 'pendulam' is unknown: choose one of" in capsys.readouterr().err
    assert run_node(['composed', '--help']) == 0
    assert 'usage: composed [ROLE ...]' in capsys.readouterr().out
