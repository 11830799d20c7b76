import numpy as np
import pytest

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.slow_frequency import (
    ESTIMATORS,
    SwingRecord,
    sinusoid_fit_frequency,
    softening,
    spectral_peak_frequency,
    stopwatch_period,
    zero_crossing_frequency,
)
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.units import RPM

FORCING, SLOW, DECAY = 1400 * RPM, 2.02, 0.05  # near threshold
ENCODER = 2 * np.pi / 4096
NOISE = 2e-3


def swing(duration, *, slow=SLOW, decay=DECAY, amplitude=0.1, soft=0.0):
    t = np.arange(round(duration * 1000)) * 1e-3
    softened = -np.expm1(-2 * decay * t) / (2 * decay)
    phase = slow * (t - soft * amplitude**2 * softened) + 0.3
    lines = 0.0422 * np.cos(FORCING * t - phase) + 0.0351 * np.cos(FORCING * t + phase)
    return amplitude * np.exp(-decay * t) * (np.cos(phase) - lines)


def record(angle):
    return SwingRecord(angle=angle, period=1e-3, forcing=FORCING)


def encoded(angle, rng):
    return record(np.round((angle + NOISE * rng.standard_normal(angle.size)) / ENCODER) * ENCODER)


def bound(duration):
    """Return the Cramér-Rao bound of the frequency of a decaying sinusoid whose four parameters are all unknown."""
    t = np.arange(round(duration * 1000)) * 1e-3
    e, phase = np.exp(-DECAY * t), SLOW * t + 0.3
    gradient = np.stack(
        [e * np.cos(phase), e * np.sin(phase), 0.1 * t * e * np.sin(phase), 0.1 * t * e * np.cos(phase)]
    )
    sigma = np.hypot(NOISE, ENCODER / np.sqrt(12))
    return sigma * np.sqrt(np.linalg.inv(gradient @ gradient.T)[2, 2])


def test_without_noise_the_fit_is_exact():
    assert sinusoid_fit_frequency(record(swing(10.0))).value == pytest.approx(SLOW, rel=1e-9)


def test_softened_swing_gives_the_small_one():
    wide = record(swing(10.0, soft=2.75))
    assert sinusoid_fit_frequency(wide, softening=2.75).value == pytest.approx(SLOW, rel=1e-5)
    assert sinusoid_fit_frequency(wide).value < SLOW * (1 - 0.01)


def test_fit_is_near_the_statistical_limit_and_knows_its_error():
    rng = np.random.default_rng(1)
    found = [sinusoid_fit_frequency(encoded(swing(8.0), rng)) for _ in range(40)]
    errors = np.array([estimate.value for estimate in found]) - SLOW
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(bound(8.0), rel=0.35)  # 40 draws know it to 11 %
    assert np.mean([estimate.sigma for estimate in found]) == pytest.approx(bound(8.0), rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize('duration', [6.0, 10.0, 20.0])
def test_targets_near_threshold(duration):
    rng = np.random.default_rng(2)
    fitted, highest = [], []
    for _ in range(200):
        noisy = encoded(swing(duration), rng)
        fitted.append(sinusoid_fit_frequency(noisy).value - SLOW)
        highest.append(spectral_peak_frequency(noisy).value - SLOW)
    rms = np.sqrt(np.mean(np.square(fitted)))
    assert rms < 1.2 * bound(duration)
    assert np.sqrt(np.mean(np.square(highest))) > 200 * rms


def test_peak_lies_within_its_bin_and_crossings_within_their_error():
    rng = np.random.default_rng(3)
    noisy = encoded(swing(20.0), rng)
    peak, crossings = spectral_peak_frequency(noisy), zero_crossing_frequency(noisy)
    assert abs(peak.value - SLOW) < 2 * np.pi / 20
    assert peak.sigma == pytest.approx(2 * np.pi / 20 / np.sqrt(12), rel=1e-9)
    assert abs(crossings.value - SLOW) < 5 * crossings.sigma < 0.01


def test_drive_nulled_record_keeps_the_swing_and_loses_the_forcing():
    times, means = record(swing(10.0, decay=1e-9)).drive_nulled()
    turn = 2 * np.pi / FORCING
    kept = np.sinc(SLOW * turn / (2 * np.pi))  # of an average over one turn
    assert means == pytest.approx(0.1 * kept * np.cos(SLOW * times + 0.3), abs=2e-4)
    assert np.abs(swing(10.0, decay=1e-9)[:1000] - 0.1 * np.cos(SLOW * np.arange(1000) * 1e-3 + 0.3)).max() > 5e-3


@pytest.mark.parametrize('release', [0.05, 0.1, 0.12, 0.15])
def test_softening_is_that_of_the_nonlinear_pendulum(release):
    # rotation numbers at 2500 RPM, released at the bottom of the stroke, where the slow swing is wider by 1/(1 − q/2)
    truth = {0.05: 114.70461632669398, 0.1: 114.36988454811008, 0.12: 114.17356200978686, 0.15: 113.81225007473898}
    amplitude = release / (1 - 3 * 0.0127 / (2 * 0.24765))
    shift = 1 - truth[release] / 114.81621968856437
    assert softening(Plant(), 2500 * RPM, release) * amplitude**2 == pytest.approx(shift, rel=1e-6)


def test_softening_is_that_of_kapitsas_potential():
    """Averaging leaves θ″ = G sin θ − H sin θ cos θ: a Duffing oscillator with Ω² = H − G and α = 2H/3 − G/6."""
    plant, speed = Plant(), 2500 * RPM
    gravity, stiffness = plant.k * plant.gravity, (plant.k * plant.amplitude * speed) ** 2 / 2
    duffing = 3 / 8 * (2 * stiffness / 3 - gravity / 6) / (stiffness - gravity)
    assert softening(plant, speed, 0.05) == pytest.approx(duffing, rel=0.05)


def test_where_nothing_swings_nothing_softens():
    for speed, release in ((1300 * RPM, 0.12), (1400 * RPM, 0.8)):
        with pytest.raises(PhysicsError):
            softening(Plant(), speed, release)


@pytest.mark.parametrize('name', ESTIMATORS)
def test_every_estimator_gives_the_small_swing_of_a_wide_one(name):
    """Within its own error, and that of the mean of A²: the correction itself is of 1.4 %."""
    found = ESTIMATORS[name](record(swing(20.0, soft=2.75)), 2.75)
    assert found.value == pytest.approx(SLOW, abs=2 * found.sigma + 1e-3 * SLOW)
    assert found.decay == pytest.approx(DECAY, rel=0.05)


def test_laps_make_good_the_display_and_the_rhythm():
    stopwatch = StopwatchSettings(
        reaction_time=0.11, reaction_jitter=0.07, anticipation=0.5, display_resolution=0.01, persistence=0.03
    )
    estimate = stopwatch_period([1.80, 1.90], [3, 3], stopwatch)
    assert estimate.value == pytest.approx((1.85 + 0.005 + 0.055) / 3)
    assert estimate.sigma == pytest.approx(np.sqrt((2 * 0.07**2 + 0.01**2 / 12) / 2) / 3)


@pytest.mark.parametrize(
    ('make', 'message'),
    [
        (lambda: sinusoid_fit_frequency(record(swing(2.0))), 'whole slow period'),
        (lambda: zero_crossing_frequency(record(0.1 + 0 * swing(2.0))), '0 passage'),
        (lambda: zero_crossing_frequency(record(swing(10.0)), 300.0), 'cannot be reduced'),
        (lambda: record(np.full(1000, np.nan)), 'finite'),
        (lambda: record(swing(0.1)), 'eight turns'),
        (lambda: SwingRecord(angle=np.zeros(1000), period=0.1, forcing=FORCING), 'more often'),
        (lambda: stopwatch_period([], [], StopwatchSettings()), 'no period'),
        (lambda: stopwatch_period([0.0], [3], StopwatchSettings()), 'no period'),
    ],
)
def test_records_that_tell_nothing_say_why(make, message):
    with pytest.raises(AnalysisError, match=message):
        make()
