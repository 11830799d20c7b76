"""The theories between the averaged equation and the nonlinear truth."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from truth import ENTRIES, plant_of, speed_of

from kapitsa_ros.physics import theory
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.release import Release
from kapitsa_ros.units import RPM

IDEAL = Plant()
SPEED = 2500 * RPM


def entry(name):
    found = ENTRIES[name]
    return found, plant_of(found['params']), speed_of(found['params'])


@pytest.mark.parametrize('name', ['play_0.2mm', 'play_0.5mm', 'play_1mm'])
def test_effective_amplitude_under_play_is_first_order(name):
    found, plant, speed = entry(name)
    second_order = 2.0 * (plant.clearance / plant.amplitude) ** 2
    slow = theory.slow_frequency_with_play(plant, speed) / RPM
    assert slow == pytest.approx(found['value'], rel=second_order + 1e-3)


@pytest.mark.parametrize('ratio', [0.05, 0.3, 1.0, 3.0])
def test_dithered_factor_is_the_work_over_a_cycle(ratio):
    def sliding(psi):
        return np.arcsin(min(1.0, ratio * abs(np.tan(psi)))) * np.sin(psi)

    bends = (0.0, np.arctan(1.0 / ratio), np.pi / 2)
    quarter = sum(quad(sliding, begin, end, epsabs=1e-12)[0] for begin, end in itertools.pairwise(bends))
    assert theory.dithered_factor(ratio) == pytest.approx(4.0 * 2.0 / np.pi * quarter, rel=1e-10)


def test_dithered_factor_between_its_limits():
    assert theory.dithered_factor(1e12) == pytest.approx(4.0, rel=1e-9)
    # At small r the describing function is viscous (report, eq. 21): the work grows as the logarithm allows.
    assert theory.dithered_factor(1e-4) < 1e-2
    ratios = [theory.dithered_factor(ratio) for ratio in np.logspace(-3, 3, 30)]
    assert np.all(np.diff(ratios) > 0)


def test_equivalent_damping_is_equation_21():
    plant = replace(IDEAL, coulomb=0.7)
    printed = 4 * plant.length * plant.coulomb / (3 * math.pi * plant.amplitude * SPEED * 0.1)
    assert theory.equivalent_damping(plant, SPEED, 0.1) == pytest.approx(printed, rel=1e-14)


@pytest.mark.parametrize('damping', [0.0, 3.0, 15.0])
@pytest.mark.parametrize('amplitude', [0.006, 0.012, 0.024])
def test_next_order_threshold_errs_with_the_fourth_power_of_the_stroke(amplitude, damping):
    plant = Plant(amplitude=amplitude, damping=damping)
    exact = theory.omega_crit_exact(plant)
    assert theory.omega_crit_next_order(plant) == pytest.approx(exact, rel=0.02 * theory.mathieu_q(plant) ** 4 + 1e-12)


def test_each_rung_is_nearer_at_a_small_swing():
    errors = [abs(each.error) for each in theory.compare_theories(IDEAL, SPEED, 1e-3)]
    assert errors[0] > 100 * errors[1] > 1000 * errors[2] > 0
    assert errors[-1] == 0


def test_the_effective_potential_follows_large_swings():
    for release, within in ((0.12, 1e-4), (0.3, 4e-4), (0.6, 2e-3)):
        truth = theory.slow_frequency_nonlinear(IDEAL, SPEED, release)
        found = theory.slow_frequency_large(IDEAL, SPEED, theory.slow_swing(IDEAL, SPEED, release))
        assert found == pytest.approx(truth, rel=within)


def test_where_the_pivot_is_at_release_matters():
    """From rest at mid-stroke 0.1 rad swings to 0.198, at the bottom to 0.108."""
    assert theory.slow_swing(IDEAL, SPEED, 0.1, math.pi / 2) == pytest.approx(0.198, abs=1e-3)
    assert theory.slow_swing(IDEAL, SPEED, 0.1, 0.0) == pytest.approx(0.108, abs=5e-4)
    run = Release(plant=IDEAL, speed=SPEED, angle=0.1, phase=math.pi / 2).strobed(400)
    seen = np.abs(run.angle).max() / (1 - IDEAL.k * IDEAL.amplitude)
    assert seen == pytest.approx(0.198, abs=2e-3)


def test_beyond_the_barrier_it_falls():
    with pytest.raises(PhysicsError, match='falls'):
        theory.slow_swing(IDEAL, 1400 * RPM, 0.9)
    with pytest.raises(PhysicsError, match='barrier'):
        theory.slow_frequency_large(IDEAL, 1400 * RPM, 1.5)
    with pytest.raises(PhysicsError, match='no lines'):
        theory.sidebands(IDEAL, 1200 * RPM)
