import math

import numpy as np
import pytest
from laboratory import jigsaw_at, swing
from scipy.integrate import solve_ivp

from kapitsa_ros.physics.errors import MotionError, ParameterError
from kapitsa_ros.physics.pendulum import Pendulum
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.units import RPM

IDEAL = Plant()


def reference(plant, speed, release, end):
    """Integrate the analytic cosine with SciPy at its tightest."""

    def slope(t, y):
        load = plant.gravity + plant.amplitude * speed**2 * math.cos(speed * t)
        return [y[1], plant.k * load * math.sin(y[0]) - plant.damping * y[1]]

    return solve_ivp(slope, (0, end), [release, 0.0], method='DOP853', rtol=2.3e-14, atol=1e-16).y[:, -1]


@pytest.mark.parametrize('rpm', [1400, 2500, 4000])
@pytest.mark.parametrize('plant', [IDEAL, Plant(damping=0.3, length=0.2, gravity=3.7, inertia_factor=0.7)])
def test_sampled_motion_agrees_with_the_analytic_cosine(rpm, plant):
    _, angle, rate, _ = swing(plant, rpm * RPM, 0.1, blocks=100)
    expected = reference(plant, rpm * RPM, 0.1, 10.0)
    assert angle[-1] == pytest.approx(expected[0], abs=1e-10)
    assert rate[-1] == pytest.approx(expected[1], abs=1e-8)


def test_block_size_does_not_matter():
    ends = [swing(IDEAL, 2500 * RPM, 0.1, blocks=3000 // n, duration=n / 1000, count=n)[1][-1] for n in (50, 100, 1000)]
    assert np.ptp(ends) < 2e-12


def test_the_order_of_the_interpolation_is_ten():
    """Halve the sampling: the error of the sampled pivot's motion falls by the tenth power."""
    speed = 4000 * RPM
    expected = reference(IDEAL, speed, 0.1, 2.0)[0]
    coarse, fine = (
        abs(swing(IDEAL, speed, 0.1, blocks=2, duration=1.0, count=n)[1][-1] - expected) for n in (640, 1280)
    )
    assert coarse < 5e-9
    assert fine < coarse / 2**8 or fine < 1e-12


def test_same_input_same_bytes():
    plant = Plant(coulomb=0.7, clearance=2e-4)
    first, second = (swing(plant, 2500 * RPM, 0.1, blocks=20)[1] for _ in range(2))
    assert first.tobytes() == second.tobytes()


def test_acceleration_is_that_of_the_equation_of_motion():
    plant = Plant(damping=0.2, coulomb=0.5)
    jigsaw = jigsaw_at(250.0)
    pendulum = Pendulum(plant)
    pendulum.hold(0.1)
    pendulum.release()
    pivot = jigsaw.advance(250.0, 0.1, 100)
    motion = pendulum.advance(pivot)
    torque = plant.k * (plant.gravity + pivot.acceleration) * np.sin(motion.position)
    expected = torque - plant.damping * motion.rate - plant.coulomb * np.sign(motion.rate)
    np.testing.assert_allclose(motion.acceleration[1:], expected[1:], rtol=1e-10)


def test_held_until_released_at_the_bottom_of_the_stroke():
    jigsaw, pendulum = jigsaw_at(250.0), Pendulum(IDEAL)
    jigsaw.advance(250.0, 0.013, 13)
    pendulum.hold(0.1)
    held = pendulum.advance(jigsaw.advance(250.0, 0.1, 100))
    assert pendulum.held
    assert np.all(held.position == 0.1)
    start = jigsaw.phi
    pendulum.release()
    motion = pendulum.advance(jigsaw.advance(250.0, 0.1, 100))
    assert not pendulum.held
    bottom = (2 * math.pi - start) / 250.0
    free = np.arange(101) * 1e-3 > bottom
    assert np.all(motion.position[~free] == 0.1)
    assert np.all(motion.position[free] != 0.1)
    expected = reference(IDEAL, 250.0, 0.1, 0.1 - bottom)
    assert motion.position[-1] == pytest.approx(expected[0], abs=1e-12)


def test_released_at_once_where_the_pivot_rests():
    jigsaw, pendulum = jigsaw_at(250.0), Pendulum(IDEAL)
    jigsaw.advance(0.0, 0.1, 10)
    pendulum.hold(0.05)
    pendulum.release()
    motion = pendulum.advance(jigsaw.advance(0.0, 0.1, 100))
    rate = math.sqrt(IDEAL.k * IDEAL.gravity)
    assert motion.position[-1] == pytest.approx(0.05 * math.cosh(0.1 * rate), rel=1e-3)


def test_falls_over_and_rests():
    _, angle, rate, pendulum = swing(IDEAL, 1000 * RPM, -0.3, blocks=40)
    assert pendulum.fell
    assert angle[-1] == -math.pi / 2
    assert rate[-1] == 0
    assert np.all(np.abs(angle) <= math.pi / 2)
    pendulum.hold(0.1)
    assert pendulum.held
    assert not pendulum.fell


@pytest.mark.parametrize('stop', [0.0, math.nan, -1.0, math.inf])
def test_bad_stop(stop):
    with pytest.raises(ParameterError, match='stop'):
        Pendulum(IDEAL, stop=stop)


@pytest.mark.parametrize('angle', [math.nan, math.pi, -1.6])
def test_bad_angle(angle):
    with pytest.raises(ParameterError, match='angle'):
        Pendulum(IDEAL).hold(angle)


def test_too_coarse_a_pivot_is_refused_and_changes_nothing():
    pendulum = Pendulum(IDEAL)
    pendulum.hold(0.1)
    pendulum.release()
    with pytest.raises(MotionError, match='coarse'):
        pendulum.advance(jigsaw_at(4000 * RPM).advance(4000 * RPM, 0.2, 100))
    assert pendulum.held
    assert pendulum.angle == 0.1


def test_fine_sampling_of_a_high_pivot_is_not_taken_for_coarse():
    """Rounding of a position far from 0 must not look like missing detail."""
    pivot = jigsaw_at(250.0).advance(250.0, 0.01, 1000)
    raised = SampledMotion(
        period=pivot.period, position=pivot.position + 1, rate=pivot.rate, acceleration=pivot.acceleration
    )
    ends = []
    for block in (pivot, raised):
        pendulum = Pendulum(IDEAL)
        pendulum.hold(0.1)
        pendulum.release()
        ends.append(pendulum.advance(block).position[-1])
    assert ends[1] == pytest.approx(ends[0], abs=1e-12)


@pytest.mark.parametrize('samples', [2, 3, 4])
def test_short_blocks(samples):
    """Blocks of fewer samples than the stencil has are interpolated by what there is."""
    jigsaw, pendulum = jigsaw_at(20.0), Pendulum(IDEAL)
    pendulum.hold(0.1)
    pendulum.release()
    period = 5e-5
    for _ in range(round(0.02 / period / (samples - 1))):
        pendulum.advance(jigsaw.advance(20.0, period * (samples - 1), samples - 1))
    end = round(0.02 / period / (samples - 1)) * (samples - 1) * period
    assert pendulum.angle == pytest.approx(reference(IDEAL, 20.0, 0.1, end)[0], abs=1e-10)


def test_samples_too_far_apart_for_a_quick_rod_are_refused():
    """At 1 kHz the pivot of a 1 mm rod is known well enough, but not the rod."""
    quick = Plant(length=0.001)
    with pytest.raises(MotionError, match='quick a rod'):
        swing(quick, 2500 * RPM, 0.01, blocks=1)
    swing(quick, 2500 * RPM, 0.01, blocks=1, count=1000)


@pytest.mark.parametrize(
    ('period', 'sizes', 'value'),
    [
        (0.0, (3, 3, 3), 0.0),
        (math.nan, (3, 3, 3), 0.0),
        (0.1, (3, 2, 3), 0.0),
        (0.1, (1, 1, 1), 0.0),
        (0.1, (3, 3, 3), math.inf),
    ],
)
def test_samples_that_are_no_motion(period, sizes, value):
    with pytest.raises(MotionError):
        SampledMotion(period, *(np.full(size, value) for size in sizes))
