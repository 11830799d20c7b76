import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from kapitsa_ros.physics.errors import MotionError, ParameterError
from kapitsa_ros.physics.jigsaw import Jigsaw, crank
from kapitsa_ros.physics.jigsaw_parameters import JigsawParameters

LAMBDA = 0.0127


def test_pure_cosine_is_the_reports():
    jigsaw = Jigsaw(amplitude=LAMBDA, parameters=JigsawParameters(spin_up=1e5, phase=0.3))
    jigsaw.advance(250.0, 0.1, 10)
    start = jigsaw.phi
    block = jigsaw.advance(250.0, 0.1, 100)
    phi = start + 250.0 * np.linspace(0, 0.1, 101)
    np.testing.assert_allclose(block.position, -LAMBDA * np.cos(phi), rtol=0, atol=1e-15)
    np.testing.assert_allclose(block.rate, 250 * LAMBDA * np.sin(phi), rtol=0, atol=1e-12)
    np.testing.assert_allclose(block.acceleration, 250**2 * LAMBDA * np.cos(phi), rtol=0, atol=1e-10)


@pytest.mark.parametrize('ratio', [1.01, 2.0, 5.0, 1e6])
def test_crank_satisfies_its_constraint_and_derivatives(ratio):
    """The connecting rod has one length, and the derivatives are those of the height."""
    phi = np.linspace(0, 2 * np.pi, 721)
    height, slope, curvature = crank(phi, ratio)
    rod = np.hypot(np.sin(phi), height + ratio + np.cos(phi))  # from the crank's pin to the pivot
    np.testing.assert_allclose(rod, ratio, rtol=1e-13)
    assert height[0] == pytest.approx(-1, abs=1e-14)
    assert height[360] == pytest.approx(1, abs=1e-14)
    # Complex steps differentiate without cancellation.
    step = 1e-30
    height_c = -np.cos(phi + 1j * step) + np.sqrt(ratio**2 - np.sin(phi + 1j * step) ** 2) - ratio
    np.testing.assert_allclose(slope, height_c.imag / step, rtol=0, atol=1e-12)
    lift = phi + 1j * step
    tilt = np.sin(lift) * np.cos(lift) / np.sqrt(ratio**2 - np.sin(lift) ** 2)
    np.testing.assert_allclose(curvature, (np.sin(lift) - tilt).imag / step, rtol=0, atol=1e-11)


def test_a_very_long_rod_gives_the_pure_cosine():
    phi = np.linspace(0, 2 * np.pi, 100)
    for long, pure in zip(crank(phi, 1e9), crank(phi, 0), strict=True):
        np.testing.assert_allclose(long, pure, rtol=0, atol=2e-9)


def test_blocks_join_in_phase_and_speed_while_running_up():
    jigsaw = Jigsaw(amplitude=LAMBDA, parameters=JigsawParameters(rod_ratio=4, spin_up=400.0))
    blocks = [jigsaw.advance(230.0, 0.1, 100) for _ in range(12)]
    for before, after in pairwise(blocks):
        assert after.position[0] == pytest.approx(before.position[-1], abs=1e-15)
        assert after.rate[0] == pytest.approx(before.rate[-1], abs=1e-12)
    assert jigsaw.speed == 230.0


def test_speed_reaches_the_target_at_the_end_of_a_step():
    jigsaw = Jigsaw(amplitude=LAMBDA, parameters=JigsawParameters(spin_up=500.0))
    speeds = []
    for _ in range(5):
        jigsaw.advance(130.0, 0.1, 10)
        speeds.append(jigsaw.speed)
    assert speeds == pytest.approx([50.0, 100.0, 130.0, 130.0, 130.0])
    jigsaw.advance(0.0, 0.1, 10)
    assert jigsaw.speed == pytest.approx(80.0)


def test_acceleration_is_the_derivative_of_the_rate_while_running_up():
    block = Jigsaw(amplitude=LAMBDA, parameters=JigsawParameters(rod_ratio=3, spin_up=900.0)).advance(90.0, 0.1, 4000)
    middle = (block.rate[2:] - block.rate[:-2]) / (2 * block.period)
    np.testing.assert_allclose(middle, block.acceleration[1:-1], rtol=0, atol=1e-4 * np.abs(block.acceleration).max())


def test_phase_loses_nothing_over_many_steps():
    """The phase after many steps is the rational one to the last bit."""
    speed = 2 * math.pi * 40.005
    jigsaw = Jigsaw(amplitude=LAMBDA, parameters=JigsawParameters(spin_up=1e5))
    jigsaw.advance(speed, 0.1, 1)
    start = jigsaw.phi
    for _ in range(10_000):
        jigsaw.advance(speed, 0.1, 1)
    # In rationals: the turns of 10,000 steps of the doubles `speed` and 0.1.
    turns = 10_000 * Fraction(speed) * Fraction(0.1) / Fraction('6.283185307179586476925286766559005768394338798750')
    expected = (start + 2 * math.pi * float(turns % 1)) % (2 * math.pi)
    assert jigsaw.phi == pytest.approx(expected, abs=2e-15)


def test_a_resting_jigsaw_keeps_still():
    block = Jigsaw(amplitude=LAMBDA, parameters=JigsawParameters(phase=1.0)).advance(0.0, 0.1, 10)
    assert np.ptp(block.position) == 0
    assert not block.rate.any()
    assert not block.acceleration.any()


@pytest.mark.parametrize('speed', [-1.0, math.nan, math.inf, 421.0])
def test_a_speed_it_cannot_do(speed):
    with pytest.raises(MotionError, match='speed'):
        Jigsaw(amplitude=LAMBDA, parameters=JigsawParameters(max_speed=420.0)).advance(speed, 0.1, 100)


@pytest.mark.parametrize(
    'wrong',
    [
        {'amplitude': 0.0},
        {'amplitude': math.nan},
        {'rod_ratio': 1.0},
        {'rod_ratio': -2.0},
        {'rod_ratio': math.inf},
        {'phase': math.inf},
        {'spin_up': 0.0},
        {'max_speed': -1.0},
    ],
)
def test_bad_parameters(wrong):
    with pytest.raises(ParameterError, match=next(iter(wrong))):
        Jigsaw(amplitude=wrong.pop('amplitude', LAMBDA), parameters=JigsawParameters(**wrong))


@pytest.mark.parametrize(('duration', 'count'), [(0.0, 10), (-0.1, 10), (math.nan, 10), (0.1, 0)])
def test_a_step_that_is_none(duration, count):
    with pytest.raises(MotionError, match='step'):
        Jigsaw(amplitude=LAMBDA).advance(10.0, duration, count)
