import sys
from dataclasses import asdict
from fractions import Fraction

import numpy as np
import pytest
from scipy.stats import norm

from kapitsa_ros.analysis.assumptions import Assumptions
from kapitsa_ros.analysis.critical_speed import Bound, Evidence, Ruler, direct_fit, errors_in_variables
from kapitsa_ros.analysis.critical_speed.direct_fit import CurveFit
from kapitsa_ros.analysis.errors import AnalysisError, TableError
from kapitsa_ros.analysis.strobe_alias import find_alias
from kapitsa_ros.analysis.table import Readings
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.tables import load_table
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.floquet import omega_crit_exact, slow_frequency_exact
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear
from kapitsa_ros.reporting.allowances import allowances
from kapitsa_ros.units import RPM

SPEEDS = np.array([2240.0, 2640.0, 2780.0]) * RPM
IDEAL = Plant()
ONLY_LIGHT_DAMPING = Assumptions(play_probability=0.0, heavy_damping_probability=0.0, coulomb_probability=0.0)


def readings(forcing, period, period_sigma=0.033, forcing_sigma=0.0):
    forcing, period = np.asarray(forcing, float), np.asarray(period, float)
    return Readings(forcing, period, np.full_like(forcing, forcing_sigma), np.full_like(period, period_sigma))


def periods(plant, release=0.12, speeds=SPEEDS):
    return np.array([2 * np.pi / slow_frequency_nonlinear(plant, speed, release) for speed in speeds])


def of_timed(timed, release=0.12, **bounds):
    size = timed.period.size
    return Evidence(timed=timed, release=np.full(size, release), swings=np.full(size, 3.0), **bounds)


def evidence(plant, sigma=1e-6, release=0.12, **bounds):
    return of_timed(readings(SPEEDS, periods(plant, release), sigma), release, **bounds)


@pytest.mark.parametrize(
    'plant',
    [
        IDEAL,
        Plant(inertia_factor=0.7),
        Plant(length=0.15, amplitude=0.008),
        Plant(gravity=1.62),
        Plant(length=0.2, amplitude=0.025),
    ],
)
def test_exact_periods_give_the_exact_threshold_whatever_the_rod(plant):
    speeds = omega_crit_exact(plant) * np.array([1.4, 1.8, 2.1])
    timed = readings(speeds, periods(plant, speeds=speeds), 1e-6)
    fit = direct_fit(
        of_timed(timed),
        Ruler(amplitude=plant.amplitude),
        plant.gravity,
        ONLY_LIGHT_DAMPING,
    )
    truth = omega_crit_exact(plant)
    assert fit.omega_crit == pytest.approx(truth, rel=2e-5)
    assert fit.interval[0] < truth < fit.interval[1] < 1.006 * truth  # 1.0052 found: the tail of c's half-normal prior
    assert fit.k == pytest.approx(plant.k, rel=1e-3)


@pytest.mark.parametrize('sigma', [0.033, 1e-4])
@pytest.mark.parametrize('speeds', [SPEEDS, np.array([1420.0, 1600.0]) * RPM])
def test_more_passes_than_the_fit_takes_change_nothing(monkeypatch, sigma, speeds):
    timed = of_timed(readings(speeds, periods(Plant(inertia_factor=0.98), speeds=speeds), sigma))
    found = direct_fit(timed, Ruler(amplitude=0.0127))
    monkeypatch.setattr(sys.modules[CurveFit.__module__], '_SETTLED', 0.0)
    settled = direct_fit(timed, Ruler(amplitude=0.0127))
    uncertainty = settled.interval[1] - settled.interval[0]
    assert abs(found.omega_crit - settled.omega_crit) < 1e-5 * uncertainty


def test_line_misses_what_the_curve_does_not():
    line = errors_in_variables(evidence(IDEAL).timed)
    assert line.omega_crit / RPM - 1354.80 > 3  # the width of the swing, and averaging


def test_wrong_ruler_is_overruled_by_exact_periods():
    by_ruler = omega_crit_exact(Plant(amplitude=0.0128)) / RPM
    fit = direct_fit(evidence(IDEAL), Ruler(amplitude=0.0128))
    assert by_ruler < 1354.80 - 8
    assert fit.omega_crit / RPM == pytest.approx(1354.80, abs=0.8)
    assert fit.interval[0] / RPM < 1354.80 < fit.interval[1] / RPM


def test_interval_without_other_causes_is_the_middle_95_percent():
    # with a very good ruler one parameter is left, and the posterior can be integrated by hand
    light = Assumptions(
        play_probability=0.0, heavy_damping_probability=0.0, coulomb_probability=0.0, light_damping=1e-3
    )
    fit = direct_fit(evidence(IDEAL, 0.033), Ruler(amplitude=0.0127, sigma=1e-9), assumptions=light)

    def chi_squared(omega_crit):
        factor = (omega_crit_exact(IDEAL) / omega_crit) ** 2  # k goes as ω_crit⁻², but for the small term of q²
        plant = Plant(inertia_factor=factor)
        slow = np.array([slow_frequency_exact(plant, speed) for speed in SPEEDS])
        width = 2 * np.pi / periods(IDEAL) / np.array([slow_frequency_exact(IDEAL, speed) for speed in SPEEDS])
        return float(np.sum((periods(IDEAL) - 2 * np.pi / (slow * width)) ** 2) / 0.033**2)

    grid = np.linspace(1230.0, 1470.0, 481) * RPM
    density = np.exp([-0.5 * chi_squared(speed) for speed in grid])
    below = [density[grid < end].sum() / density.sum() for end in fit.interval]
    assert below == pytest.approx([0.025, 0.975], abs=0.002)


def bound(rpm):
    return Bound(speed=rpm * RPM, sigma=0.5 * RPM, release=0.12)


def test_falls_and_stands_narrow_the_interval():
    free = direct_fit(evidence(IDEAL, 0.033), Ruler(amplitude=0.0127))
    bounded = direct_fit(
        evidence(IDEAL, 0.033, fell=(bound(1345),), stood=(bound(1368),)),
        Ruler(amplitude=0.0127),
    )
    low, high = (end / RPM for end in bounded.interval)
    # a release of 0.12 rad falls from up to 0.36 % above the threshold
    assert free.interval[0] / RPM < 1338 < low < 1354.8 < high < 1370 < free.interval[1] / RPM


def test_periods_that_do_not_follow_the_curve_widen_the_interval():
    nudged = periods(IDEAL) * np.array([1.0 - 0.004, 1.0 + 0.003, 1.0 - 0.002])
    fit = direct_fit(
        of_timed(readings(SPEEDS, nudged, 1e-6)),
        Ruler(amplitude=0.0127),
    )
    assert fit.chi_squared > 1000
    assert 0.002 < fit.discrepancy < 0.006
    assert fit.amplitude == pytest.approx(0.0127, abs=0.25e-3)  # the ruler is believed, not bent
    low, high = (end / RPM for end in fit.interval)
    assert low < 1354.80 < high
    assert high - low > 20
    assert direct_fit(evidence(IDEAL), Ruler(amplitude=0.0127)).discrepancy == 0.0


def test_fall_above_a_speed_at_which_it_stood_bounds_nothing():
    fit = direct_fit(evidence(IDEAL, 0.033, fell=(bound(2500),), stood=(bound(1500),)), Ruler(amplitude=0.0127))
    assert fit.discrepancy is None
    assert fit.interval == (None, None)


def test_errors_in_variables_on_the_table_of_1997():
    fit = errors_in_variables(load_table('1997'))
    assert fit.omega_crit / RPM == pytest.approx(1616.86, abs=0.01)
    assert fit.chi_squared < 0.1
    assert fit.interval[0] < fit.omega_crit < fit.interval[1] < 2240 * RPM


def test_periods_that_hardly_quicken_leave_the_interval_open_below():
    fit = errors_in_variables(readings(SPEEDS, [0.62, 0.60, 0.61], 0.05))
    assert fit.interval[0] is None
    assert fit.omega_crit is None or fit.omega_crit < 2240 * RPM


def test_error_of_the_speed_widens_the_interval_by_its_effect():
    speeds = np.array([1600.0, 2200, 2780]) * RPM
    period, wobble = periods(IDEAL, speeds=speeds), 3 * RPM
    sharp = errors_in_variables(readings(speeds, period, 0.003))
    blurred = errors_in_variables(readings(speeds, period, 0.003, wobble))
    assert np.diff(blurred.interval) > 1.1 * np.diff(sharp.interval)
    # the same widening by hand: σ_T and T′σ_ω in quadrature
    moved = period * speeds / (speeds**2 - sharp.omega_crit**2) * wobble
    by_hand = errors_in_variables(Readings(speeds, period, 0 * speeds, np.hypot(0.003, moved)))
    assert np.diff(blurred.interval) == pytest.approx(np.diff(by_hand.interval), rel=0.05)


@pytest.mark.slow
def test_line_covers_the_truth_as_often_as_it_says():
    slope, critical = 0.0029, 1400 * RPM
    speeds = np.array([1700.0, 2000, 2300, 2700]) * RPM
    true = 2 * np.pi / np.sqrt(slope * (speeds**2 - critical**2))
    rng = np.random.default_rng(5)
    hits = 0
    for _ in range(400):
        low, high = errors_in_variables(readings(speeds, true + 0.02 * rng.standard_normal(4), 0.02)).interval
        hits += (low is None or low <= critical) and (high is None or critical <= high)
    assert abs(hits / 400 - 0.95) < 4 * np.sqrt(0.95 * 0.05 / 400)


def test_swings_that_slow_down_with_speed_leave_all_open():
    fit = errors_in_variables(readings(SPEEDS, [0.50, 0.60, 0.70], 0.01))
    assert fit.omega_crit is None
    assert fit.interval == (None, None)


def test_one_speed_is_no_line_but_enough_with_a_ruler():
    timed = readings(SPEEDS[:1], periods(IDEAL)[:1], 0.01)
    with pytest.raises(TableError):
        errors_in_variables(timed)
    fit = direct_fit(
        of_timed(timed),
        Ruler(amplitude=0.0127),
    )
    # Ω ≈ kλω/√2 far above the threshold, and ω_crit² = 2g/(kλ²)
    assert fit.omega_crit / RPM == pytest.approx(1354.8, abs=0.1)
    spread = (fit.interval[1] - fit.interval[0]) / (2 * norm.ppf(0.975)) / fit.omega_crit
    assert 0.004 < spread < 0.02


def test_without_a_timing_there_is_nothing_to_fit():
    with pytest.raises(AnalysisError, match='no swing was timed'):
        direct_fit(of_timed(readings([], [])), Ruler(amplitude=0.0127))


@pytest.mark.parametrize('ratio', [3 / 4, 2 / 3, 5 / 8, 3 / 2, 5 / 4, 1 / 3])
def test_fooled_reading_is_undone(ratio):
    strobe = load_instruments('1997').strobe
    assert find_alias(ratio * 2506 * RPM, 2500 * RPM, strobe) == Fraction(ratio).limit_denominator(10)


def test_reading_that_is_merely_wrong_is_left_alone():
    strobe = load_instruments('1997').strobe
    assert find_alias(2506 * RPM, 2500 * RPM, strobe) == 1
    assert find_alias(0.91 * 2500 * RPM, 2500 * RPM, strobe) == 1
    assert find_alias(2700 * RPM, 2500 * RPM, strobe) == 1


def test_a_sample_of_few_rods_is_said_to_be_one():
    assumed = asdict(Assumptions())
    (said,) = allowances(assumed, 0.5, 0.1, 100.0)
    assert 'Coulomb friction, a miscount in 2 % of timings with a count' in said
    assert 'its ends are rough' in allowances(assumed, 0.5, 0.1, 3.0)[1]
    assert not allowances(assumed, None, None, None)
