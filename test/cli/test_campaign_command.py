import json

import numpy as np
import pytest
from click.testing import CliRunner

from kapitsa_ros.cli.commands.campaign import campaign
from kapitsa_ros.cli.commands.plan import plan
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.laboratory.campaign import perform_all
from kapitsa_ros.laboratory.dask_cluster import DaskCluster
from kapitsa_ros.laboratory.errors import ClusterError
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.units import RPM


def values(command, *arguments):
    result = CliRunner().invoke(command, [*arguments, '--json'])
    assert result.exception is None, result.exception
    return json.loads(result.stdout)


def test_campaign_has_the_keys_of_the_contract():
    found = values(campaign, '--experiments', '4')
    assert found.keys() == {
        'experiments',
        'failed',
        'omega_crit_rpm',
        'coverage95',
        'interval_width_rpm',
        'unbounded',
        'wall_s',
        'efficiency',
    }
    assert found['omega_crit_rpm'].keys() == {'median', 'p16', 'p84'}
    experiment = SimulatedExperiment(
        plant=Plant(), instruments=load_instruments('1997'), protocol=load_protocol('1997'), seed=1
    )
    speeds = [outcome.omega_crit / RPM for outcome in perform_all(experiment, 4)]
    assert found['omega_crit_rpm']['median'] == pytest.approx(np.median(speeds))


def test_experiments_that_all_fail_say_why():
    result = CliRunner().invoke(campaign, ['--experiments', '2', '--amplitude', '1mm'])
    assert 'no swing could be timed at 2240, 2640, 2780 RPM' in result.stdout
    assert 'nan' not in result.stdout


def test_cluster_gives_what_the_cores_give():
    distributed = pytest.importorskip('distributed')
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
    ) as cluster:
        there = values(campaign, '--experiments', '3', '--scheduler', cluster.scheduler_address)
    here = values(campaign, '--experiments', '3')
    assert there['omega_crit_rpm'] == here['omega_crit_rpm']


def test_a_cluster_without_workers_is_refused_and_left():
    distributed = pytest.importorskip('distributed')
    with distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=None) as cluster:
        with pytest.raises(ClusterError, match='no workers'):
            DaskCluster(cluster.scheduler_address)
        with pytest.raises(ValueError, match='No global client'):
            distributed.get_client()


def test_nobody_at_the_address():
    pytest.importorskip('distributed')
    with pytest.raises(ClusterError, match='no Dask scheduler'):
        DaskCluster('nonsense://127.0.0.1:1')


def test_plan_has_the_keys_of_the_contract():
    found = values(plan, '--target', '3')
    assert {'speeds_rpm', 'periods', 'repeats', 'expected_percent'} <= found.keys()
    assert found['expected_percent'] <= 3
    assert found['separation']['between'] == ['inertia_factor', 'large_swing']


def test_plan_says_where_no_timing_decides():
    said = CliRunner().invoke(plan, ['--target', '3']).stdout
    assert 'To tell inertia_factor from large_swing: time a swing of 0.05 rad' in said
    # where the rod was built so slow, a slower one and a wide swing are both next to nothing
    built = CliRunner().invoke(plan, ['--target', '3', '--inertia-factor', '0.7069']).stdout
    assert 'No single timing tells inertia_factor from large_swing' in built


def test_what_is_taken_for_granted_widens_intervals_and_is_said() -> None:
    plain, doubted = (
        CliRunner().invoke(campaign, ['--experiments', '1', *more, '--json'])
        for more in ([], ['--assume', 'dial_u=0.03'])
    )
    widths = [json.loads(result.stdout)['interval_width_rpm']['median'] for result in (plain, doubted)]
    assert widths[1] > 1.2 * widths[0]
    said = (
        CliRunner().invoke(campaign, ['--experiments', '1', '--assume', 'dial_u=0.03'], env={'COLUMNS': '120'}).stdout
    )
    assert 'allows for play up to 2.5 mm, damping up to 6 1/s, Coulomb friction, a miscount in 2 % of timings' in said
    assert 'the calibration of the dial (u = 3 %)' in said
