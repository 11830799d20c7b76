"""Every published number of truth.json, and how many of its digits come out: run with -s to see them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from laboratory import swing
from scipy.optimize import brentq
from truth import ENTRIES, matching_digits, plant_of, speed_of

from kapitsa_ros.analysis.line_fit import fit_inverse_ols, fit_ols, slope_ratio
from kapitsa_ros.analysis.table import Readings
from kapitsa_ros.physics import theory
from kapitsa_ros.physics.release import Release
from kapitsa_ros.physics.run_summary import summarise_run
from kapitsa_ros.units import RPM


def upper_threshold(_):
    """Return λ/L where b₁(q) = 0."""
    return brentq(theory.characteristic_b1, 0.5, 1.5, xtol=1e-14) / 3


def nonlinear(params):
    return theory.slow_frequency_nonlinear(plant_of(params), speed_of(params), params['theta0'], params['phase']) / RPM


def buzz(params):
    plant, speed = replace(plant_of(params), coulomb=0.3), speed_of(params)
    return theory.buzz_angle(plant, speed) / theory.stuck_zone(plant, speed)


def readings(params):
    forcing = np.array(params['rpm']) * RPM
    period = np.array(params['T']) if 'T' in params else 60.0 / np.array(params['slow'])
    return Readings(forcing, period, np.zeros_like(forcing), np.full_like(period, 0.05))


def with_the_slope_of_theory(params):
    """Return ω_crit of the line through the mean point."""
    taken, plant = readings(params), plant_of(params)
    line = fit_ols(taken)
    slope = line.slope / slope_ratio(line, plant)
    return math.sqrt(np.mean(taken.forcing**2) - np.mean(taken.slow**2) / slope) / RPM


def with_the_intercept_of_theory(params):
    """Return ω_crit of the best line through −kg on the axis of Ω²."""
    taken, plant = readings(params), plant_of(params)
    weight = plant.k * plant.gravity
    slope = np.sum(taken.forcing**2 * (taken.slow**2 + weight)) / np.sum(taken.forcing**4)
    return math.sqrt(weight / slope) / RPM


def cycle_mean(angle, samples_a_turn):
    window = np.ones(samples_a_turn + 1)
    window[[0, -1]] = 0.5
    return np.convolve(angle, window / samples_a_turn, mode='valid')


def slow_swing(params):
    """Return the mean of θ over a turn round every sample, the samples before its zeros, and the zeros' times."""
    speed = speed_of(params)
    turn = 2 * math.pi / speed
    times, angle, _, _ = swing(plant_of(params), speed, params['theta0'], blocks=60, duration=2 * turn, count=96)
    mean = cycle_mean(angle, 48)
    times = times[24 : 24 + mean.size]
    sign = np.nonzero(mean[1:] * mean[:-1] < 0)[0]
    return mean, sign, times[sign] - mean[sign] * (times[sign + 1] - times[sign]) / (mean[sign + 1] - mean[sign])


def peak(params):
    mean, crossings, _ = slow_swing(params)
    return np.abs(mean[crossings[1] : crossings[2]]).max()


def slow_period(params):
    _, _, crossings = slow_swing(params)
    return crossings[2] - crossings[0]


def slow_in_play(params):
    """Return the slow frequency of a swing small enough to be linear, from its map at the bottoms of the stroke."""
    turn = 2 * math.pi / speed_of(params)
    _, angle, rate, _ = swing(plant_of(params), speed_of(params), 0.002, blocks=500, duration=turn, count=24)
    strobed, paced = angle[480::24], rate[480::24]  # the first 20 turns let the hole settle on the pin
    following = np.stack((strobed[1:], paced[1:]))
    before = np.stack((strobed[:-1], paced[:-1]))
    monodromy = following @ np.linalg.pinv(before)
    return abs(np.angle(np.linalg.eigvals(monodromy)[0])) / turn / RPM


def drift(params):
    return summarise_run(Release(plant=plant_of(params), speed=speed_of(params), angle=params['theta0']), 300.0).growth


# What an entry's name begins with, how its value comes about, and how many digits must match.
EXACT = 12.5
ANSWERS = {
    'q': (lambda params: theory.mathieu_q(plant_of(params)), EXACT),
    'a_': (lambda params: theory.mathieu_a(plant_of(params), speed_of(params)), EXACT),
    'a0_q': (lambda params: theory.characteristic_a0(params['q']), EXACT),
    'b1_q': (lambda params: theory.characteristic_b1(params['q']), EXACT),
    'lamL': (upper_threshold, EXACT),
    'wcrit_avg': (lambda params: theory.omega_crit_averaged(plant_of(params)) / RPM, EXACT),
    'wcrit': (lambda params: theory.omega_crit_exact(plant_of(params)) / RPM, EXACT),
    'slow_avg': (lambda params: theory.slow_frequency_averaged(plant_of(params), speed_of(params)) / RPM, EXACT),
    'slow': (lambda params: theory.slow_frequency_exact(plant_of(params), speed_of(params)) / RPM, EXACT),
    'growth': (lambda params: theory.growth_rate(plant_of(params), speed_of(params)), EXACT),
    'nl_': (nonlinear, EXACT),
    'drift': (drift, 12),
    'fit_ols': (lambda params: fit_ols(readings(params)).omega_crit / RPM, EXACT),
    'fit_ols_slope_ratio': (lambda params: slope_ratio(fit_ols(readings(params)), plant_of(params)), EXACT),
    'fit_inverse': (lambda params: fit_inverse_ols(readings(params)).omega_crit / RPM, EXACT),
    'fit_slope_fixed': (with_the_slope_of_theory, EXACT),
    'fit_intercept_fixed': (with_the_intercept_of_theory, EXACT),
    # These were published with the digits that their own computation had.
    'sb_lower': (lambda params: theory.sidebands(plant_of(params), speed_of(params))[0], 5),
    'sb_upper': (lambda params: theory.sidebands(plant_of(params), speed_of(params))[1], 5),
    'coul_K': (
        lambda params: theory.dithered_factor(theory.dither_ratio(plant_of(params), speed_of(params))),
        7,
    ),
    'coul_loss': (lambda params: theory.amplitude_loss(replace(plant_of(params), coulomb=1.0), speed_of(params)), 7),
    'theta_s': (lambda params: theory.stuck_zone(plant_of(params), speed_of(params)), EXACT),
    'buzz': (buzz, 4),
    'coul_peak3': (peak, 4),
    'coul_T1': (slow_period, 2.4),
    'play': (slow_in_play, 4.7),
    'crit_play': (lambda params: theory.omega_crit_with_play(plant_of(params)) / RPM, 7.0),
}


@pytest.mark.parametrize('name', ENTRIES)
def test_published_value(name):
    entry = ENTRIES[name]
    answer, fewest = ANSWERS[max((begin for begin in ANSWERS if name.startswith(begin)), key=len)]
    value = answer(entry['params'])
    assert matching_digits(value, entry) > fewest
    scale = abs(entry['value']) if entry['tol_kind'] == 'rel' else 1.0
    assert abs(value - entry['value']) <= entry['tol'] * scale
