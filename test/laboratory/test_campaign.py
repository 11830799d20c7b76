import pickle
import socket
import threading
import tracemalloc
from contextlib import ExitStack, suppress

import numpy as np
import pytest

import kapitsa_ros as kr
from kapitsa_ros.analysis.critical_speed import Ruler, direct_fit, evidence_of
from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.line_fit import fit_inverse_ols
from kapitsa_ros.analysis.timing_row import timing_rows
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.laboratory import dask_cluster
from kapitsa_ros.laboratory.campaign import Outcome, efficiency, perform, perform_all, summarise
from kapitsa_ros.laboratory.dask_cluster import of_versions
from kapitsa_ros.laboratory.errors import ClusterError
from kapitsa_ros.laboratory.outcomes import Outcomes
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.network.errors import RunError
from kapitsa_ros.operator.protocol import Protocol
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.floquet import omega_crit_exact
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear
from kapitsa_ros.physics.theory.play import omega_crit_with_play
from kapitsa_ros.units import RPM, is_within
from kapitsa_ros.versions import versions

IDEAL = Plant()
TRUTH = omega_crit_exact(IDEAL)


def experiment(plant=IDEAL, instruments='1997', protocol=None, seed=1):
    return SimulatedExperiment(
        plant=plant,
        instruments=load_instruments(instruments),
        protocol=protocol or load_protocol('1997'),
        seed=seed,
    )


class Here:
    count = 1

    def map(self, function, seeds):
        return map(function, seeds)


def test_blind_analysis_of_ideal_readings_sees_what_averaging_misses():
    evidence = evidence_of(timing_rows(experiment(instruments='ideal').runs()))
    for speed, period in zip(evidence.timed.forcing, evidence.timed.period, strict=True):
        assert period == pytest.approx(2 * np.pi / slow_frequency_nonlinear(IDEAL, speed, 0.12), rel=1e-5)
    fit = direct_fit(evidence, Ruler(amplitude=IDEAL.amplitude))
    assert fit.omega_crit / RPM == pytest.approx(1354.8036, rel=2e-4)  # averaged theory is 1.3e-3 away
    assert fit.interval[0] < TRUTH < fit.interval[1]


def test_friction_of_a_bearing_stays_within_the_interval():
    fit = direct_fit(
        evidence_of(timing_rows(experiment(load_preset('bearing'), 'ideal').runs())), Ruler(amplitude=IDEAL.amplitude)
    )
    assert fit.interval[0] < omega_crit_exact(load_preset('bearing')) < fit.interval[1]


@pytest.mark.parametrize('seed', [1, 2])
def test_friction_the_curve_does_not_know_stays_within_the_interval(seed):
    plant = load_preset('as_built_1997')  # Coulomb friction eats the swing, and one release has to be doubled
    outcome = perform(experiment(plant, 'ideal'), seed)
    assert is_within(omega_crit_with_play(plant), outcome.interval)
    assert (outcome.interval[1] - outcome.interval[0]) / RPM < 100


def test_same_seed_same_readings_and_other_seeds_others():
    runs = [experiment(seed=seed).runs() for seed in (1, 1, 2)]
    shown = [[run.readings for run in each] for each in runs]
    assert shown[0] == shown[1] != shown[2]


def test_runs_that_fall_are_bounds():
    protocol = Protocol(speeds=(1340 * RPM, 1370 * RPM, 2000 * RPM))
    evidence = evidence_of(timing_rows(experiment(protocol=protocol).runs()))
    assert [bound.speed / RPM for bound in evidence.fell] == pytest.approx([1340], abs=12)
    assert evidence.timed.forcing / RPM == pytest.approx([1370, 2000], abs=15)
    fit = direct_fit(evidence, Ruler(amplitude=IDEAL.amplitude))
    assert fit.interval[0] / RPM > 1325
    assert fit.interval[0] < TRUTH < fit.interval[1]


def test_friction_that_stops_the_swing_is_a_bound_from_above():
    sticky = Plant(coulomb=3.0)
    evidence = evidence_of(timing_rows(experiment(sticky, protocol=Protocol(speeds=(2240 * RPM,), swings=10)).runs()))
    assert len(evidence.stood) == 1
    assert not evidence.timed.period.size


def test_settings_that_describe_no_instrument_are_refused():
    runs = experiment().runs()
    runs[0].settings['strobe']['instrument']['dial_resolution'] = 'ten'
    with pytest.raises(RunError, match='strobe'):
        timing_rows(runs)
    with pytest.raises(RunError, match='no runs'):
        timing_rows([])


def test_outcomes_come_in_the_order_of_their_seeds_wherever_they_are_computed():
    here = list(perform_all(experiment(), 6, Here()))
    assert [outcome.seed for outcome in here] == [1, 2, 3, 4, 5, 6]
    pooled = list(perform_all(experiment(), 6))
    assert [(o.omega_crit, o.interval) for o in pooled] == [(o.omega_crit, o.interval) for o in here]
    assert here[0].inverse_ols == fit_inverse_ols(evidence_of(timing_rows(experiment().runs())).timed).omega_crit


def test_experiment_without_a_timing_is_failed_and_not_wrong():
    below = experiment(protocol=Protocol(speeds=(1000 * RPM,)))
    outcome = perform(below, 1)
    assert outcome.omega_crit is None
    summary = summarise([outcome], TRUTH)
    assert (summary.experiments, summary.failed) == (1, 1)
    assert np.isnan(summary.coverage)


def test_summary_counts_truth_width_and_open_ends():
    def outcome(low, high):
        return Outcome(seed=0, omega_crit=1.0, interval=(low, high), ols=None, inverse_ols=None, seconds=0.5)

    outcomes = [outcome(0.5, 2.0), outcome(1.5, 2.5), outcome(None, 2.0), outcome(None, 0.5)]
    summary = summarise(outcomes, 1.0)
    assert summary.coverage == 0.5
    assert summary.width == 1.25
    assert summary.unbounded == 2
    assert efficiency(Outcomes(outcomes).seconds, 1.0, 2) == 1.0


def test_no_experiments_are_refused():
    with pytest.raises(AnalysisError, match='one or more'):
        list(perform_all(experiment(), 0, Here()))


def test_few_experiments_scatter_about_the_truth():
    outcomes = list(perform_all(experiment(), 24))
    summary = summarise(outcomes, TRUTH)
    assert summary.failed == summary.unbounded == 0
    assert summary.coverage >= 20 / 24  # 95 % of 24; fewer come once in 150 such lots
    errors = np.array([outcome.omega_crit / TRUTH - 1 for outcome in outcomes])
    assert abs(errors.mean()) < 4 * errors.std() / np.sqrt(24)
    assert 0.008 < errors.std() < 0.025


@pytest.mark.slow
def test_thousand_intervals_hold_the_truth_as_often_as_they_say():
    summary = summarise(list(perform_all(experiment(), 1000)), TRUTH)
    assert 0.93 <= summary.coverage <= 0.97
    assert summary.failed == 0


def test_worn_pivot_has_a_lower_threshold_and_the_interval_knows():
    worn = load_preset('as_built_1997')
    assert omega_crit_with_play(worn) == pytest.approx(
        omega_crit_exact(worn) / (1 + 2 / np.pi * worn.clearance / worn.amplitude), rel=1e-3
    )
    assert omega_crit_with_play(IDEAL) == TRUTH
    outcomes = list(perform_all(experiment(worn), 12))
    assert sum(is_within(omega_crit_with_play(worn), outcome.interval) for outcome in outcomes) >= 10


def test_a_hundred_thousand_outcomes_are_a_few_megabytes():
    """So the memory of a campaign is what its workers need, however many experiments it has."""

    def stream():
        for seed in range(1, 100_001):
            interval = (None if seed % 1000 else 1.0, 2.0)
            failure = f'number {seed % 7}' if seed % 100 == 0 else None
            omega = None if failure else 1.5
            yield Outcome(
                seed=seed,
                omega_crit=omega,
                interval=interval,
                ols=None,
                inverse_ols=None,
                seconds=0.01,
                failure=failure,
            )

    tracemalloc.start()
    try:
        found = Outcomes(stream())
        kept, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert kept < 50 * 100_000
    assert found.seconds == pytest.approx(1000.0)
    assert found.seed[[0, -1]].tolist() == [1, 100_000]
    assert found.failure[98:101] == (None, 'number 2', None)
    assert np.isnan(found.omega_crit).sum() == 1000


@pytest.mark.parametrize(
    'address',
    [
        '',
        '127.0.0.1',
        'http://127.0.0.1:8786',
        'tcp://',
        'tcp://127.0.0.1:abc',
        'a.json',
        'inproc://x',
        'inproc://127.0.0.1/1/1',
    ],
)
def test_what_is_no_address_of_a_scheduler_is_refused_at_once(address, monkeypatch):
    distributed = pytest.importorskip('distributed')
    monkeypatch.setattr(distributed, 'Client', None)  # none is made, which would not be closed in silence
    with pytest.raises(ClusterError, match='no Dask scheduler can be at'):
        kr.campaign(experiments=1, scheduler=address)


@pytest.fixture
def server():
    """Return a function that starts a server, which sends something to whoever connects, and returns its address."""
    with ExitStack() as stack:

        def start(greeting):
            listening = stack.enter_context(socket.create_server(('127.0.0.1', 0)))

            def answer():
                with suppress(OSError):  # once it is shut down
                    while True:
                        connection = stack.enter_context(listening.accept()[0])
                        connection.sendall(greeting)

            thread = threading.Thread(target=answer)
            thread.start()
            stack.callback(thread.join)
            stack.callback(listening.shutdown, socket.SHUT_RDWR)
            return '{}:{}'.format(*listening.getsockname())

        yield start


@pytest.mark.parametrize(
    ('greeting', 'message'), [(b'', 'none in 1 s'), (b'SSH-2.0-a', 'speaks otherwise'), (b'\0' * 8, 'speaks otherwise')]
)
def test_a_server_of_another_protocol_is_not_waited_for_for_ever(server, greeting, message, monkeypatch):
    distributed = pytest.importorskip('distributed')
    monkeypatch.setattr(dask_cluster, '_PATIENCE', 1.0)
    monkeypatch.setattr(distributed, 'Client', None)
    with pytest.raises(ClusterError, match=f'no Dask scheduler answers at 127.* {message}'):
        kr.campaign(experiments=1, scheduler=server(greeting))


def test_the_address_of_a_worker_is_told_from_that_of_its_scheduler():
    distributed = pytest.importorskip('distributed')
    one = {'n_workers': 1, 'threads_per_worker': 1, 'processes': False, 'dashboard_address': None}
    with distributed.LocalCluster(**one) as cluster:
        (worker,) = cluster.scheduler.workers
        with pytest.raises(ClusterError, match='but a Worker: give the address of its scheduler'):
            kr.campaign(experiments=1, scheduler=worker)


def test_a_worker_that_comes_later_with_other_versions_computes_nothing():
    with pytest.raises(ClusterError, match=r'later has other versions: kapitsa_ros .+ for 0\.0\.7') as refused:
        of_versions({**versions(), 'kapitsa_ros': '0.0.7'}, lambda _: [], (experiment(), range(1)))
    assert str(pickle.loads(pickle.dumps(refused.value))) == str(refused.value)  # noqa: S301  # so it comes home
    assert of_versions(versions(), lambda _: [], (experiment(), range(1))) == []
