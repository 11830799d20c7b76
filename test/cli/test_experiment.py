"""The main job through the graph: the same bytes whatever happens around it, and true figures."""

import filecmp
import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from domain_of_process import domain_of
from mcap.reader import make_reader

from kapitsa_ros.laboratory.bag_analysis import analyse_bags
from kapitsa_ros.network import registry
from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.physics.pendulum import Pendulum
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.resources import resource_path
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.ros.rig_client import RigClient
from kapitsa_ros.units import RPM

Kapitsa = Callable[..., Any]
Recorded = tuple[Path, dict[str, Any]]


def same_bytes(left: Path, right: Path) -> bool:
    """Whether two folders hold the same files with the same bytes."""
    names = sorted(str(path.relative_to(left)) for path in left.rglob('*') if path.is_file())
    others = sorted(str(path.relative_to(right)) for path in right.rglob('*') if path.is_file())
    return names == others and filecmp.cmpfiles(left, right, names, shallow=False)[0] == names


def comparable(values: dict[str, Any]) -> dict[str, Any]:
    """Leave out what may differ between equal experiments: speed of the machine, paths, what a bag does not tell."""
    runs = [{key: value for key, value in run.items() if key != 'bag'} for run in values['runs']]
    own = {'realtime_factor', 'protocol'}
    return {key: value for key, value in values.items() if key not in own} | {'runs': runs}


def test_keys_are_those_of_the_contract(recorded: Recorded) -> None:
    values = recorded[1]
    assert set(values) == {
        'runs', 'omega_crit_rpm', 'omega_crit_interval_rpm', 'inverse_rpm', 'ols_rpm', 'predicted_rpm',
        'error_percent', 'truth_rpm', 'discrepancy_percent', 'realtime_factor', 'deviation_percent', 'timings',
        'ruler', 'play_probability', 'heavy_damping_probability', 'effective_rods', 'assumptions',
        'plant', 'instruments', 'protocol', 'seed', 'version',
    }  # fmt: skip
    for run, rpm in zip(values['runs'], (2240, 2640, 2780), strict=True):
        assert set(run) == {
            'bag', 'run', 'speed_reading_rpm', 'period_s', 'slow_rpm', 'fell', 'samples', 'gaps', 'digest_ok',
            'defects',
        }  # fmt: skip
        assert run['digest_ok'] is True
        assert run['speed_reading_rpm'] == pytest.approx(rpm, abs=11)
        assert run['gaps'] == 0
        assert not run['fell']
    for timing, run in zip(values['timings'], values['runs'], strict=True):
        assert set(timing) >= {
            'run', 'speed_asked_rpm', 'speed_reading_rpm', 'speed_taken_rpm', 'alias', 'release_rad', 'kind',
            'display_s', 'swings', 'time_s',
        }  # fmt: skip
        assert timing['speed_reading_rpm'] == run['speed_reading_rpm']
        assert timing['display_s'] / timing['swings'] == pytest.approx(run['period_s'], rel=1e-12)
    assert (values['protocol'], values['seed'], values['plant']['length']) == ('1997', 1, 0.24765)
    assert values['error_percent'] == pytest.approx(100 * (values['inverse_rpm'] / values['predicted_rpm'] - 1))
    assert values['predicted_rpm'] == pytest.approx(1353.058, abs=1e-3)
    assert values['truth_rpm'] == pytest.approx(1354.8036, abs=1e-3)
    assert values['realtime_factor'] > 0


def test_the_same_seed_gives_the_same_bytes_on_a_busy_machine(
    kapitsa: Kapitsa,
    recorded: Recorded,
    tmp_path: Path,
    busy: None,  # noqa: ARG001
) -> None:
    again = kapitsa('experiment', '--preset', 'ideal', '--seed', 1, '--bags', tmp_path / 'B', '--json').json
    assert comparable(again) == comparable(recorded[1])
    assert same_bytes(recorded[0], tmp_path / 'B')


def test_bags_are_analysed_to_the_same_digits(kapitsa: Kapitsa, recorded: Recorded) -> None:
    bags = sorted(recorded[0].iterdir())
    assert comparable(kapitsa('analyse', *bags, '--json').json) == comparable(recorded[1])


@pytest.mark.parametrize('rate', [0, 5])
def test_bags_are_replayed_to_the_same_digits(kapitsa: Kapitsa, recorded: Recorded, rate: int) -> None:
    bags = sorted(recorded[0].iterdir())
    replayed = kapitsa('replay', *bags, '--rate', rate, '--json').json
    assert comparable(replayed) == comparable(recorded[1])
    if rate:
        assert replayed['realtime_factor'] < 1.05 * rate


@pytest.mark.slow
def test_live_replayed_and_offline_the_result_has_the_same_bytes_on_a_busy_machine(
    kapitsa: Kapitsa,
    tmp_path: Path,
    busy: None,  # noqa: ARG001
) -> None:
    def text(values: dict[str, Any]) -> str:
        return json.dumps(comparable(values), sort_keys=True)

    live = text(kapitsa('experiment', '--preset', 'as_built_1997', '--seed', 5, '--bags', tmp_path, '--json').json)
    bags = sorted(tmp_path.iterdir())
    assert text(kapitsa('analyse', *bags, '--json').json) == live
    for rate in (0, 1, 20):
        assert text(kapitsa('replay', *bags, '--rate', rate, '--json').json) == live, f'at rate {rate}'


def test_runs_can_be_replayed_in_any_order(kapitsa: Kapitsa, recorded: Recorded) -> None:
    first, _, last = sorted(recorded[0].iterdir())
    bags = [last, first, first]
    assert comparable(kapitsa('replay', *bags, '--json').json) == comparable(analyse_bags(bags))


def test_a_run_that_somebody_resets_is_listed_and_done_again(tmp_path: Path) -> None:
    protocol = tmp_path / 'one.yaml'
    protocol.write_text('speeds: [2240]')
    command = ['experiment', '--protocol', protocol, '--bags', tmp_path / 'bags', '--rate', '1', '--json']
    process = subprocess.Popen(
        [sys.executable, '-m', 'kapitsa_ros', *command],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stderr is not None
    assert 'run 1 of 1' in next(process.stderr)
    with on_loopback():
        domain = domain_of(process.pid)
        assert domain is not None
        client = RigClient(domain)
    with client:
        while not client.is_served():
            time.sleep(0.01)  # discovery takes its own time, and tells nobody
        answered = client.call('reset')
        client.set_parameters(rate=0.0)
        out, err = process.communicate(timeout=100)
        assert answered.result().success
    assert process.returncode == 0, err
    values = json.loads(out)
    assert values['reset_runs'] == [1]
    assert 'kapitsa: warning: run 1 was cut short by a call of the service jigsaw/reset: what was timed' in err
    runs = values['runs']
    assert [Path(run['bag']).name for run in runs] == ['run_01_2240rpm', 'run_02_2240rpm']
    assert [run['period_s'] is None for run in runs] == [True, False]


def test_sqlite3_on_request(kapitsa: Kapitsa, recorded: Recorded, tmp_path: Path) -> None:
    values = kapitsa('experiment', '--seed', 1, '--bags', tmp_path, '--storage', 'sqlite3', '--json').json
    assert comparable(values) == comparable(recorded[1])
    assert (tmp_path / 'run_01_2240rpm' / 'run_01_2240rpm_0.db3').is_file()


def test_ideal_instruments_read_the_nonlinear_truth(kapitsa: Kapitsa, tmp_path: Path) -> None:
    how = ['--instruments', 'ideal', '--compression', 'none']
    values = kapitsa('experiment', *how, '--bags', tmp_path, '--json').json
    for file in tmp_path.glob('*/*.mcap'):
        with file.open('rb') as stream:
            summary = make_reader(stream).get_summary()
        assert summary is not None
        assert {chunk.compression for chunk in summary.chunk_indexes} == {''}
    for run, rpm in zip(values['runs'], (2240, 2640, 2780), strict=True):
        truth = slow_frequency_nonlinear(Plant(), rpm * RPM, 0.12) / RPM
        assert run['slow_rpm'] == pytest.approx(truth, rel=1e-3)
        assert run['speed_reading_rpm'] == pytest.approx(rpm, rel=1e-8)
        assert run['gaps'] == 0


def test_the_motion_in_the_bag_is_that_of_the_sampled_pivot(recorded: Recorded) -> None:
    for path in sorted(recorded[0].iterdir()):
        bag = RunBag(path)
        commands = {read_step_id(raw): registry.COMMAND.decode(raw) for _, _, raw in bag.raw(registry.COMMAND.name)}
        pendulum = Pendulum(bag.run.plant)
        angles = [np.array([0.12])]
        for step_id, pivot in bag.pivot():
            hold = commands[step_id].hold
            if hold is None:
                pendulum.release()
            else:
                pendulum.hold(hold)
            angles.append(pendulum.advance(pivot).position[1:])
        assert np.abs(np.concatenate(angles) - bag.motion.angle).max() < 1e-9
        assert np.ptp(bag.motion.angle) > 0.2


def test_the_shipped_runs_are_those_of_the_command_that_made_them(kapitsa: Kapitsa) -> None:
    """Readings only: motions may differ in the last digit from one processor to the next."""
    bags = sorted(path for path in resource_path('bags').iterdir() if path.is_dir())
    assert [path.name for path in bags] == ['run_01_2240rpm', 'run_02_2640rpm', 'run_03_2780rpm']
    assert sum(file.stat().st_size for path in bags for file in path.iterdir()) < 2_000_000
    values = kapitsa('analyse', *bags, '--json').json
    assert [run['gaps'] for run in values['runs']] == [0, 0, 0]
    assert values['truth_rpm'] == pytest.approx(1594.92, abs=0.01)
    for run, period in zip(values['runs'], (1.0, 0.75, 0.68), strict=True):
        assert run['period_s'] == pytest.approx(period, abs=0.08)
