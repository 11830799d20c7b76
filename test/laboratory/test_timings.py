"""Each timing and each fall counts at its own speed, with the same repairs for every estimate."""

import numpy as np
import pytest

from kapitsa_ros.analysis.critical_speed import ruler_of
from kapitsa_ros.analysis.experiment import Experiment, reduce_runs
from kapitsa_ros.analysis.line_fit import fit_inverse_ols
from kapitsa_ros.analysis.results import experiment_values
from kapitsa_ros.analysis.table import Readings
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.laboratory.bag_analysis import origin
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.operator.protocol import Protocol
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.reporting.report_tables import repairs
from kapitsa_ros.units import RPM


def found(*rpm: float, sweep: bool = True, repeats: int = 1, release: float = 0.12) -> Experiment:
    protocol = Protocol(speeds=tuple(speed * RPM for speed in rpm), sweep=sweep, repeats=repeats, release=release)
    experiment = SimulatedExperiment(plant=Plant(), instruments=load_instruments('ideal'), protocol=protocol, seed=1)
    return reduce_runs(experiment.runs())


def test_two_speeds_timed_in_one_run_give_what_two_runs_give() -> None:
    swept, apart = found(2240, 2780), found(2240, 2780, sweep=False)
    assert swept.omega_crit is not None
    assert swept.omega_crit / RPM == pytest.approx(1354.8, abs=0.5)
    assert swept.omega_crit == pytest.approx(apart.omega_crit, rel=1e-6)
    assert swept.inverse_ols == pytest.approx(apart.inverse_ols, rel=1e-6)
    assert [(row.run, round((row.speed or 0) / RPM)) for row in swept.timings] == [(1, 2240), (1, 2780)]


def test_a_fall_at_the_second_speed_is_a_bound_there() -> None:
    swept = found(2240, 1340)
    assert [row.kind for row in swept.timings] == ['timed', 'fell']
    assert [round((row.speed or 0) / RPM) for row in swept.timings] == [2240, 1340]
    assert swept.omega_crit is not None
    assert swept.interval is not None
    assert swept.omega_crit / RPM == pytest.approx(1354.8, abs=0.5)
    assert all(end is not None for end in swept.interval)


def test_timings_at_one_reading_of_the_dial_are_one_row() -> None:
    once, twice = found(2240, 2780), found(2240, 2780, repeats=2)
    assert len(twice.timings) == 4
    assert twice.omega_crit == pytest.approx(once.omega_crit, rel=1e-6)


def test_a_reading_at_a_wrong_flash_rate_is_repaired_for_all_estimates_alike_and_said() -> None:
    """Seed 2: the marks stood doubled at 4/3 of the shaft's speed, and the person halved."""
    experiment = SimulatedExperiment(
        plant=Plant(), instruments=load_instruments('1997'), protocol=load_protocol('1997'), seed=2
    )
    values = experiment_values(reduce_runs(experiment.runs()))
    [said] = repairs(values)
    assert said == 'run 2: read 1760.0 RPM, taken as 2640.0 RPM: alias 2/3 (2640 RPM was asked for)'
    speed = np.array([timing['speed_taken_rpm'] for timing in values['timings']])
    assert speed == pytest.approx([2240, 2640, 2780], abs=15)
    half_a_digit = 0.005
    period = np.array([(timing['display_s'] + half_a_digit) / timing['swings'] for timing in values['timings']])
    by_hand = fit_inverse_ols(Readings(speed * RPM, period, 0 * speed, 0 * speed))
    assert values['inverse_rpm'] == pytest.approx((by_hand.omega_crit or 0.0) / RPM, rel=1e-9)
    assert values['error_percent'] == pytest.approx(100 * (values['inverse_rpm'] / values['predicted_rpm'] - 1))
    assert values['deviation_percent'] == pytest.approx(100 * (values['omega_crit_rpm'] / values['truth_rpm'] - 1))


def test_the_ruler_errs_by_the_seed_and_a_perfect_set_has_a_perfect_one() -> None:
    def read(instruments: str, seed: int) -> float:
        protocol = Protocol(speeds=(2240 * RPM,))
        experiment = SimulatedExperiment(
            plant=Plant(), instruments=load_instruments(instruments), protocol=protocol, seed=seed
        )
        return ruler_of(experiment.runs()[0]).amplitude

    assert read('ideal', 1) == Plant().amplitude
    slips = [read('1997', seed) - Plant().amplitude for seed in range(1, 21)]
    assert len(set(slips)) == 20
    assert slips[0] == read('1997', 1) - Plant().amplitude
    assert 0.06e-3 < np.std(slips) < 0.21e-3  # 0.125 mm, to three standard errors of twenty


def test_experiments_together_have_the_mean_of_their_rulers_in_whatever_order_they_are_given() -> None:
    first, second = (
        SimulatedExperiment(
            plant=Plant(), instruments=load_instruments('1997'), protocol=Protocol(speeds=(2640 * RPM,)), seed=seed
        ).runs()
        for seed in (1, 2)
    )
    one, other = ruler_of(*first), ruler_of(*second)
    both = ruler_of(*first, *second, *first)
    assert both.amplitude == pytest.approx((one.amplitude + other.amplitude) / 2, rel=1e-15)
    assert both.sigma == pytest.approx(one.sigma / 2**0.5, rel=1e-15)
    forth, back = (experiment_values(reduce_runs(runs)) for runs in ([*first, *second], [*second, *first]))
    assert forth['ruler'] == back['ruler'] == {'amplitude_m': both.amplitude, 'sigma_m': both.sigma}
    assert forth['omega_crit_rpm'] == pytest.approx(back['omega_crit_rpm'], rel=1e-9)
    of_two = origin([*first, *second])
    assert (of_two['seed'], origin(first)['seed']) == (None, 1)
    assert of_two['instruments'] == origin(first)['instruments']
