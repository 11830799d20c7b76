import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from laboratory import rods
from scipy.integrate import solve_ivp

from kapitsa_ros.physics import theory
from kapitsa_ros.physics.errors import ParameterError, PhysicsError
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.units import RPM

PLANTS = [
    Plant(),
    Plant(damping=3.0, inertia_factor=0.7, gravity=1.6),
    Plant(length=0.1, amplitude=0.05),
    Plant(length=0.1, amplitude=0.035, damping=40.0),
]


def monodromy(plant, speed):
    """Return the monodromy matrix of the linear equation, from SciPy at its tightest."""

    def slope(t, y):
        stiffness = plant.k * (plant.gravity + plant.amplitude * speed**2 * math.cos(speed * t))
        return [y[1], stiffness * y[0] - plant.damping * y[1]]

    ends = [
        solve_ivp(slope, (0, 2 * math.pi / speed), start, method='DOP853', rtol=3e-14, atol=1e-16).y[:, -1]
        for start in ([1.0, 0.0], [0.0, 1.0])
    ]
    return np.array(ends).T


@pytest.mark.parametrize('plant', PLANTS)
@pytest.mark.parametrize('rpm', [60, 300, 700, 1354, 2500, 9000])
def test_exponents_are_those_of_the_monodromy_matrix(plant, rpm):
    speed = rpm * RPM
    multipliers = np.linalg.eigvals(monodromy(plant, speed))
    largest = multipliers[np.argmax(np.abs(multipliers))]
    rate = math.log(abs(largest)) * speed / (2 * math.pi)
    assert theory.growth_rate(plant, speed) == pytest.approx(rate, rel=1e-9, abs=1e-10 * speed)
    slow = theory.slow_frequency_exact(plant, speed)
    if abs(largest.imag) > 1e-6 or largest.real < 0:
        assert slow == pytest.approx(abs(np.angle(largest)) * speed / (2 * math.pi), rel=1e-9)
    else:
        assert slow is None


@settings(max_examples=15)
@given(
    plant=rods(
        slenderness=st.floats(0.003, 0.9),
        length=st.floats(0.02, 2.0),
        gravity=st.floats(0.1, 100.0),
        inertia_factor=st.floats(0.5, 1.0),
        damping=st.one_of(st.just(0.0), st.floats(-3.0, 2.5).map(lambda power: 10**power)),
    ),
    above=st.floats(0.5, 4.0),
)
def test_growth_is_the_monodromys_whatever_the_rod(plant, above):
    speed = above * theory.omega_crit_averaged(plant)
    moduli = np.abs(np.linalg.eigvals(monodromy(plant, speed)))
    turn = 2 * math.pi / speed
    # A strongly damped map hardly reaches its larger multiplier's digits; SciPy's own are 1e-11 of the matrix.
    assert theory.growth_rate(plant, speed) * turn == pytest.approx(math.log(moduli.max()), rel=1e-8, abs=1e-6)


@pytest.mark.parametrize('plant', PLANTS)
def test_thresholds_part_stable_from_unstable(plant):
    lower, upper = theory.omega_crit_exact(plant), theory.omega_crit_upper(plant)
    assert not theory.is_stable(plant, lower * (1 - 1e-9))
    assert theory.is_stable(plant, lower * (1 + 1e-9))
    if theory.mathieu_q(plant) < 0.908:
        assert upper is None
        assert theory.is_stable(plant, 1e5)
    else:
        assert theory.is_stable(plant, upper * (1 - 1e-9))
        assert not theory.is_stable(plant, upper * (1 + 1e-9))


@given(
    length=st.floats(0.02, 2.0),
    slenderness=st.floats(0.003, 0.9),
    gravity=st.floats(0.1, 100.0),
    damping=st.one_of(st.just(0.0), st.floats(-15.0, 2.5).map(lambda power: 10**power)),
)
def test_thresholds_part_stable_from_unstable_whatever_the_rod(length, slenderness, gravity, damping):
    plant = Plant(length=length, amplitude=slenderness * length, gravity=gravity, damping=damping)
    lower, upper = theory.omega_crit_exact(plant), theory.omega_crit_upper(plant)
    assert theory.growth_rate(plant, lower * (1 - 1e-4)) > 0
    assert theory.growth_rate(plant, lower * (1 + 1e-4)) <= 0
    if upper is not None:
        assert theory.growth_rate(plant, upper * (1 - 1e-4)) <= 0
        assert theory.growth_rate(plant, upper * (1 + 1e-4)) > 0


def test_damping_moves_the_threshold_as_the_next_order_says():
    """ω_crit² + c², good to 0.15 RPM up to a damping ratio of 1 (against the exact undamped threshold)."""
    plant = Plant()
    for ratio in (0.2, 1.0):
        damped = replace(plant, damping=2 * ratio * math.sqrt(plant.k * plant.gravity))
        step = math.hypot(theory.omega_crit_exact(plant), damped.damping)
        assert abs(theory.omega_crit_exact(damped) - step) / RPM < 0.2
        assert theory.omega_crit_next_order(damped) == pytest.approx(theory.omega_crit_exact(damped), rel=1e-5)


def test_nonlinear_frequency_tends_to_the_linear_one_with_the_square_of_the_angle():
    plant, speed = Plant(), 2500 * RPM
    linear = theory.slow_frequency_exact(plant, speed)
    drop = [linear - theory.slow_frequency_nonlinear(plant, speed, angle) for angle in (0.02, 0.04)]
    assert drop[1] / drop[0] == pytest.approx(4, rel=2e-3)


def test_nonlinear_frequency_of_a_short_rod_near_its_upper_limit():
    """The orbit turns by almost half a turn a period there: small swings still give the linear frequency."""
    plant = Plant(length=0.1, amplitude=0.05)
    speed = 0.995 * theory.omega_crit_upper(plant)
    linear = theory.slow_frequency_exact(plant, speed)
    assert theory.slow_frequency_nonlinear(plant, speed, 1e-5) == pytest.approx(linear, rel=1e-6)


@pytest.mark.parametrize('rod', PLANTS)
def test_a_plant_of_a_threshold_swings_as_the_one_it_was_taken_from(rod):
    twin = theory.averaged.plant_of_threshold(theory.omega_crit_averaged(rod), rod.amplitude, rod.gravity, rod.damping)
    speed = 2.0 * theory.omega_crit_averaged(rod)
    assert theory.omega_crit_averaged(twin) == pytest.approx(theory.omega_crit_averaged(rod), rel=1e-14)
    assert theory.slow_frequency_exact(twin, speed) == pytest.approx(theory.slow_frequency_exact(rod, speed), rel=1e-10)


def test_averaged_frequency_does_not_exist_below_the_threshold():
    plant = Plant()
    assert theory.slow_frequency_averaged(plant, 0.999 * theory.omega_crit_averaged(plant)) is None
    assert theory.slow_frequency_exact(plant, 0.999 * theory.omega_crit_exact(plant)) is None


@pytest.mark.parametrize('speed', [0.0, -10.0, math.nan, math.inf])
def test_bad_speed(speed):
    with pytest.raises(ParameterError, match='speed'):
        theory.growth_rate(Plant(), speed)


def test_what_has_no_slow_frequency_says_so():
    plant = Plant()
    with pytest.raises(PhysicsError, match='not stable'):
        theory.slow_frequency_nonlinear(plant, 1000 * RPM, 0.1)
    with pytest.raises(PhysicsError, match='falls'):
        theory.slow_frequency_nonlinear(plant, 1400 * RPM, 0.9)
    with pytest.raises(ParameterError, match='release'):
        theory.slow_frequency_nonlinear(plant, 2500 * RPM, 0.0)


def test_what_double_precision_cannot_hold_says_so():
    with pytest.raises(PhysicsError, match='too fast'):
        theory.growth_rate(Plant(), 1e-3)
    with pytest.raises(PhysicsError, match='too fast'):
        theory.growth_rate(Plant(), 1e-200)
    with pytest.raises(PhysicsError, match='damping'):
        theory.omega_crit_exact(Plant(damping=1e8))
