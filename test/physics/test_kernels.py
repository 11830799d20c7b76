import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from kapitsa_ros.physics.kernels import layout
from kapitsa_ros.physics.kernels.cosine import WORK_SHAPE, advance_cosine
from kapitsa_ros.physics.kernels.hermite import acceleration_series, stencil_weights
from kapitsa_ros.physics.kernels.roots import NEVER, ROOM_ROWS, first_descent
from kapitsa_ros.physics.kernels.series import shift, value, value_and_slope
from kapitsa_ros.physics.kernels.slow_period import widths_after
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.mathieu import half_period
from kapitsa_ros.units import RPM

ROOTS = st.lists(st.floats(0.01, 3.0), min_size=0, max_size=5)


def first_root(polynomial, end):
    return first_descent(polynomial, end, np.full((ROOM_ROWS, polynomial.size), np.nan))


@settings(max_examples=300)
@given(ROOTS, st.lists(st.tuples(st.floats(-2, 2), st.floats(0.05, 2)), max_size=3), st.floats(0.1, 1.0))
def test_first_descent_finds_the_first_root(roots, pairs, end):
    """Of a polynomial made of its roots, real and complex, that starts positive."""
    roots = sorted(roots)
    # Nearly double roots are ill-conditioned.
    assume(all(b - a >= 0.02 for a, b in pairwise(roots)) and all(abs(one - end) >= 0.01 for one in roots))
    polynomial = np.array([1.0])
    for root in roots:
        polynomial = np.convolve(polynomial, [1.0, -1.0 / root])
    for real, imaginary in pairs:
        polynomial = np.convolve(polynomial, [real**2 + imaginary**2, -2 * real, 1.0])
    found = first_root(np.append(polynomial, 0.0), end)
    if roots and roots[0] <= end:
        assert found == pytest.approx(roots[0], rel=1e-7)
    else:
        assert found == NEVER


def test_first_descent_leaves_behind_the_event_it_starts_from():
    assert first_root(np.array([0.0, 0.0, 1.0, -2.0]), 1.0) == pytest.approx(0.5, rel=1e-15)
    assert first_root(np.array([0.0, -1.0, 5.0]), 1.0) == 0.0
    assert first_root(np.array([0.0, 1.0, 1.0]), 1.0) == NEVER


@settings(max_examples=100)
@given(st.lists(st.floats(-3, 3), min_size=1, max_size=12), st.floats(0, 1), st.floats(0, 1))
def test_a_shifted_polynomial_is_the_same(coefficients, by, at):
    series = np.array(coefficients)
    moved = series.copy()
    shift(moved, by, np.full_like(moved, np.nan))
    assert value(moved, at) == pytest.approx(np.polynomial.polynomial.polyval(by + at, series), abs=1e-9)
    slope = np.polynomial.polynomial.polyval(by, np.polynomial.polynomial.polyder(series))
    assert value_and_slope(moved, 0.0)[1] == pytest.approx(slope, abs=1e-9)


@pytest.mark.parametrize('points', [2, 3, 4])
def test_interpolation_is_exact_for_the_polynomials_it_can_hold(points):
    rng = np.random.default_rng(points)
    motion = np.polynomial.Polynomial(rng.normal(size=3 * points) / 5.0 ** np.arange(3 * points))
    times = np.arange(7.0) * 0.5
    series = np.empty((6, 3 * points - 2))
    samples = (motion(times), motion.deriv()(times), motion.deriv(2)(times))
    # Within every stencil the polynomial is the same one, so edges must be as exact as the middle.
    acceleration_series(stencil_weights(points), 0.5, *samples, series)
    for i in range(6):
        for tau in (0.0, 0.3, 0.9):
            expected = 0.25 * motion.deriv(2)(times[i] + 0.5 * tau)
            assert value(series[i], tau) == pytest.approx(expected, rel=1e-9, abs=1e-11)


@settings(max_examples=200)
@given(st.floats(-60, 5), st.floats(0.0, 4.0))
def test_the_frictionless_map_keeps_area(a, q):
    x1, r1, x2, r2 = half_period(a, q)
    size = abs(x1 * r2) + abs(r1 * x2)
    assert x1 * r2 - r1 * x2 == pytest.approx(1.0, abs=1e-12 * max(size, 1.0))


def test_the_nonlinear_map_keeps_area():
    """The determinant of the stroboscopic map at a large swing, by central differences of tenth order in rounding."""
    plant, speed = Plant(), 2500 * RPM
    constants = layout.constants(plant, stop=math.pi / 2, linear=False)

    def turn(angle, rate):
        state = layout.state_at_rest(angle, 0.0)
        state[[layout.RATE, layout.MODE]] = rate, layout.MOVING
        motion = np.empty((2, 2))
        advance_cosine(
            plant.amplitude,
            speed,
            0.0,
            2 * math.pi / speed / 16,
            1 / 16,
            16,
            constants,
            state,
            motion,
            np.empty(WORK_SHAPE),
        )
        return motion[:, 1]

    def derivative(direction, h=2e-3):
        weights = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}
        steps = [
            weight * (turn(*(centre + n * h * direction)) - turn(*(centre - n * h * direction)))
            for n, weight in weights.items()
        ]
        return np.sum(steps, axis=0) / h

    centre = np.array([0.3, 2.0])
    jacobian = np.array([derivative(np.array([1.0, 0.0])), derivative(np.array([0.0, 1.0]))]).T
    assert np.linalg.det(jacobian) == pytest.approx(1.0, abs=1e-11)


def test_the_order_of_the_series_is_sixteen():
    plant, speed = Plant(), 2500 * RPM
    constants = layout.constants(plant, stop=math.pi / 2, linear=False)

    def end(steps):
        state = layout.state_at_rest(0.12, 0.0)
        state[layout.MODE] = layout.MOVING
        motion = np.empty((2, 21))
        period = 2 * math.pi / speed
        advance_cosine(
            plant.amplitude,
            speed,
            0.0,
            period / steps,
            1 / steps,
            steps,
            constants,
            state,
            motion,
            np.empty(WORK_SHAPE),
        )
        return motion[0, -1]

    truth = end(32)
    errors = [abs(end(steps) - truth) for steps in (4, 6)]
    assert math.log(errors[0] / errors[1]) / math.log(1.5) > 15


@pytest.mark.parametrize('loss', [0.0, 0.01, 0.03])
def test_widths_go_on_smoothly_to_damping_below_0(loss: float) -> None:
    """So does a fit that looks for the best damping; where it strays far, widths are large numbers and no others."""
    damping = np.array([-2e-4, -1e-4, 0.0, 1e-4, 2e-4, -1e6])
    each, width = np.ones(damping.size), np.empty(damping.size)
    widths_after(2.0 * each, 0.01 * each, damping, 6.0 * each, loss * each, 0.12, 2.0, width)
    slopes = np.diff(width[:5])
    assert slopes == pytest.approx(slopes.mean(), rel=1e-3)
    assert width[5] > 1e9
    widths_after(2.0 * each, 0.01 * each, damping, 6.0 * each, loss * each, 0.0, 2.0, width)
    assert np.isfinite(width).all()
