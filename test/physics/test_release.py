import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from laboratory import jigsaw_at, rods, swing
from scipy.integrate import solve_ivp
from truth import ENTRIES, plant_of, speed_of

from kapitsa_ros.physics import theory
from kapitsa_ros.physics.batch import simulate_batch
from kapitsa_ros.physics.errors import ParameterError, PhysicsError
from kapitsa_ros.physics.pendulum import Pendulum
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.release import Release
from kapitsa_ros.physics.run_summary import summarise_run
from kapitsa_ros.units import RPM

IDEAL = Plant()
SPEED = 2500 * RPM

PLANTS = [
    IDEAL,
    Plant(damping=0.4, coulomb=0.7),
    Plant(coulomb=0.7, clearance=2e-4, restitution=0.3, inertia_factor=0.7069),
]


@pytest.mark.parametrize('plant', PLANTS)
def test_cosine_and_sampled_pivot_give_the_same_motion(plant):
    times, angle, rate, _ = swing(plant, SPEED, 0.1, blocks=20)
    run = Release(plant=plant, speed=SPEED, angle=0.1).sampled(2.0)
    np.testing.assert_allclose(run.time, times, rtol=0, atol=1e-12)
    np.testing.assert_allclose(run.angle, angle, rtol=0, atol=2e-11)
    np.testing.assert_allclose(run.rate, rate, rtol=0, atol=2e-9)


def test_sampled_and_strobed_runs_agree_at_any_phase():
    run = Release(plant=IDEAL, speed=SPEED, angle=0.1, phase=1.0)
    orbit = run.strobed(50)
    fine = run.sampled(float(orbit.time[-1]), 1 / float(orbit.time[-1]))
    assert fine.angle[-1] == pytest.approx(orbit.angle[-1], abs=1e-12)


def test_a_minute_ends_in_the_same_place_however_it_is_sampled():
    """Whether samples are locked to the shaft (1 kHz has 24 in a turn) or not, rounding must not add up."""
    release = Release(plant=IDEAL, speed=SPEED, angle=0.12)
    ends = [release.sampled(60.0, rate).angle[-1] for rate in (1 / 60, 100.0, 1000.0, 1024.0, 3000.0)]
    assert np.ptp(ends) < 2e-12


def test_the_frictionless_amplitude_does_not_drift():
    entry = ENTRIES['drift_exact']
    release = Release(plant=plant_of(entry['params']), speed=speed_of(entry['params']), angle=entry['params']['theta0'])
    assert abs(summarise_run(release, 300.0).growth) < 1e-12


def test_energy_is_conserved_without_drive():
    """A thousand periods of a hanging rod, at 30 degrees."""
    jigsaw, pendulum = jigsaw_at(100.0), Pendulum(IDEAL, stop=7.0)
    jigsaw.advance(0.0, 0.1, 1)
    pendulum.hold(math.pi - 0.5)
    pendulum.release()
    weight = IDEAL.k * IDEAL.gravity
    blocks = math.ceil(1000 * 2 * math.pi / math.sqrt(weight))
    energy = []
    for _ in range(blocks):
        motion = pendulum.advance(jigsaw.advance(0.0, 1.0, 100))
        energy.append(0.5 * motion.rate[-1] ** 2 + weight * math.cos(motion.position[-1]))
    assert np.ptp(energy) < 1e-10 * weight


def test_growth_and_frequency_of_a_damped_rod_are_floquets():
    plant = Plant(damping=0.6)
    slow = summarise_run(Release(plant=plant, speed=SPEED, angle=0.05, phase=0.7, linear=True), 10.0)
    assert slow.growth == pytest.approx(-0.3, rel=1e-10)
    assert slow.frequency == pytest.approx(theory.slow_frequency_exact(plant, SPEED), rel=1e-12)
    nonlinear = summarise_run(Release(plant=plant, speed=SPEED, angle=0.01), 10.0)
    assert nonlinear.frequency == pytest.approx(slow.frequency, rel=1e-5)


def test_growth_of_a_falling_rod_is_floquets():
    slow = summarise_run(Release(plant=IDEAL, speed=1200 * RPM, angle=1e-6), 10.0)
    assert slow.growth == pytest.approx(theory.growth_rate(IDEAL, 1200 * RPM), rel=1e-3)
    assert slow.frequency is None


def test_friction_stops_the_rod():
    release = Release(plant=Plant(coulomb=2.0), speed=SPEED, angle=0.12)
    assert 2 < summarise_run(release, 5.0).periods < 4
    assert summarise_run(release, 5.0).growth < 0


def test_many_rods_move_as_one_alone():
    angles = np.linspace(-0.3, 0.3, 7)
    ends = simulate_batch(IDEAL, speed=SPEED, angle=angles, phase=0.4, duration=3.0)
    for angle, end in zip(angles, ends.angle, strict=True):
        alone = Release(plant=IDEAL, speed=SPEED, angle=float(angle), phase=0.4).sampled(3.0, 1 / 3.0)
        assert end == pytest.approx(alone.angle[-1], abs=1e-12)
    assert not ends.fell.any()
    assert simulate_batch(IDEAL, speed=[1000 * RPM, SPEED], angle=0.1, duration=10.0).fell.tolist() == [True, False]


@pytest.mark.parametrize(
    'wrong',
    [{'speed': 0.0}, {'speed': math.nan}, {'angle': 1.6}, {'angle': math.nan}, {'phase': math.inf}],
)
def test_bad_release(wrong):
    with pytest.raises(ParameterError, match=next(iter(wrong))):
        Release(**{'plant': IDEAL, 'speed': SPEED, 'angle': 0.1, **wrong})


@pytest.mark.parametrize(('duration', 'rate'), [(0.0, 1e3), (math.nan, 1e3), (1e-4, 1e3), (1.0, 0.0), (1.0, math.inf)])
def test_bad_duration(duration, rate):
    with pytest.raises(ParameterError, match='duration'):
        Release(plant=IDEAL, speed=SPEED, angle=0.1).sampled(duration, rate)


@pytest.mark.parametrize('wrong', [{'speed': [SPEED, -1.0]}, {'angle': 2.0}, {'phase': math.nan}, {'duration': 0.0}])
def test_bad_ensemble(wrong):
    with pytest.raises(ParameterError):
        simulate_batch(IDEAL, **{'speed': SPEED, 'angle': 0.1, 'duration': 1.0, **wrong})


@pytest.mark.parametrize(
    'wrong',
    [
        {'length': 0.0},
        {'length': -0.25},
        {'length': math.nan},
        {'amplitude': math.inf},
        {'gravity': 0.0},
        {'damping': -0.1},
        {'coulomb': -1.0},
        {'clearance': -1e-4},
        {'clearance': 0.02},
        {'restitution': 1.1},
        {'restitution': -0.1},
        {'inertia_factor': 0.0},
        {'wear': -1.0},
        {'failure_clearance': 0.0},
    ],
)
def test_bad_plant(wrong):
    with pytest.raises(ParameterError, match=next(iter(wrong))):
        Plant(**wrong)


def test_too_fast_a_fall_is_refused():
    """A hole that strikes a very light rod's pin throws it round faster than the shortest steps can follow."""
    plant = Plant(clearance=5e-3, length=1e-3, inertia_factor=1e3)
    with pytest.raises(PhysicsError, match='too wildly'):
        Release(plant=plant, speed=SPEED, angle=1.0, phase=math.pi).sampled(0.1)
    with pytest.raises(PhysicsError, match='too wildly'):
        simulate_batch(plant, speed=SPEED, angle=1.0, phase=math.pi, duration=0.1)


def test_impacts_too_thick_to_be_told_apart_are_refused():
    plant = Plant(clearance=1e-12, restitution=1.0)
    with pytest.raises(PhysicsError, match='too close together'):
        Release(plant=plant, speed=SPEED, angle=0.1).sampled(1.0)
    with pytest.raises(PhysicsError, match='too close together'):
        simulate_batch(plant, speed=SPEED, angle=0.1, duration=1.0)
    with pytest.raises(PhysicsError, match='too close together'):
        swing(plant, SPEED, 0.1, blocks=3)


@settings(max_examples=15)
@given(
    plant=rods(
        slenderness=st.floats(0.01, 0.6),
        length=st.floats(0.05, 2.0),
        gravity=st.floats(0.1, 30.0),
        inertia_factor=st.floats(0.5, 1.0),
        damping=st.floats(0.0, 100.0),
    ),
    rpm=st.floats(500, 4000),
    angle=st.floats(-0.5, 0.5),
    phase=st.floats(0.0, 6.28),
)
def test_a_run_is_what_scipy_makes_of_it_whatever_the_rod(plant, rpm, angle, phase):
    speed, end = rpm * RPM, 3 * 60 / rpm

    def slope(t, y):
        load = plant.gravity + plant.amplitude * speed**2 * math.cos(speed * t + phase)
        return [y[1], plant.k * load * math.sin(y[0]) - plant.damping * y[1]]

    def falls(_, y):
        return abs(y[0]) - math.pi / 2

    falls.terminal = True
    known = solve_ivp(slope, (0, end), [angle, 0.0], method='DOP853', rtol=3e-14, atol=1e-16, events=falls)
    run = Release(plant=plant, speed=speed, angle=angle, phase=phase).sampled(end, 1 / end)
    assert run.fell == (known.status == 1)
    assert run.angle[-1] == pytest.approx(known.y[0, -1], abs=1e-9)
