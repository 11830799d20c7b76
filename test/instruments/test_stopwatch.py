import numpy as np
import pytest
from motions import blocks, swing

from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.instruments.errors import InstrumentError
from kapitsa_ros.instruments.random_streams import random_stream
from kapitsa_ros.instruments.stopwatch import Stopwatch
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.units import RPM

SLOW, FORCING = 12.0, 2500 * RPM
IDEAL = load_instruments('ideal').stopwatch


def readings(watch, steps):
    return [reading for start, motion in steps if (reading := watch.observe(start, motion)) is not None]


def timed(settings, *, seed=0, swings=3, run=0, **cut):
    watch = Stopwatch(settings, swings, random_stream(seed, 'stopwatch', run))
    (reading,) = readings(watch, blocks(swing(SLOW, FORCING, 0.12, 1.2345), 8.0, **cut))
    return reading


@pytest.mark.parametrize('angle', [0.12, -0.12])
@pytest.mark.parametrize('cut', [{}, {'count': 53}, {'count': 130}, {'count': 400, 'period': 2.5e-4}])
def test_ideal_stopwatch_is_not_shifted_by_the_sidebands(cut, angle):
    watch = Stopwatch(IDEAL, 3, random_stream(0, 'stopwatch', 0))
    (reading,) = readings(watch, blocks(swing(SLOW, FORCING, angle, 1.2345), 8.0, **cut))
    assert (reading.kind, reading.swings) == ('timed', 3)
    assert reading.displayed / 3 == pytest.approx(2 * np.pi / SLOW, rel=1e-5)
    assert reading.pressed_at == pytest.approx(1.2345 + (0.75 + 3) * 2 * np.pi / SLOW, abs=1e-4)


def test_without_the_blur_the_sidebands_do_shift_a_passage():
    raw = timed(StopwatchSettings(persistence=0.0))
    assert abs(raw.displayed / 3 - 2 * np.pi / SLOW) > 1e-5 * 2 * np.pi / SLOW


def test_press_errors_have_the_published_mean_and_spread():
    settings = StopwatchSettings(reaction_time=0.11, reaction_jitter=0.07)
    seen = [timed(settings, seed=seed) for seed in range(150)]
    errors = np.array([reading.displayed for reading in seen]) - 3 * 2 * np.pi / SLOW
    late = np.array([reading.pressed_at for reading in seen]) - (1.2345 + 3.75 * 2 * np.pi / SLOW)
    assert abs(errors.mean()) < 4 * 0.07 * np.sqrt(2 / 150)  # the mean delay cancels
    assert errors.std() == pytest.approx(0.07 * np.sqrt(2), rel=0.25)
    assert late.mean() == pytest.approx(0.11, abs=4 * 0.07 / np.sqrt(150))


def test_display_shows_completed_hundredths():
    exact, shown = timed(IDEAL).displayed, timed(StopwatchSettings(display_resolution=0.01)).displayed
    assert 0 <= exact - shown < 0.01
    assert shown == pytest.approx(np.floor(exact * 100) / 100)


def test_anticipation_shortens_by_the_delay_of_the_last_press():
    settings = StopwatchSettings(reaction_time=0.11, anticipation=1.0)
    assert timed(settings).displayed == pytest.approx(timed(IDEAL).displayed - 0.11, abs=1e-9)


def test_rate_error_scales_the_display():
    assert timed(StopwatchSettings(rate_error=0.57)).displayed == pytest.approx(1.57 * timed(IDEAL).displayed)


def test_miscounts_are_off_by_one_swing_as_often_as_told():
    shown = np.array([timed(StopwatchSettings(miscount_probability=0.4), seed=seed).displayed for seed in range(200)])
    off = np.round(shown / (2 * np.pi / SLOW)).astype(int) - 3
    assert set(off) == {-1, 0, 1}
    assert np.mean(off != 0) == pytest.approx(0.4, abs=4 * np.sqrt(0.24 / 200))


def test_never_before_its_time_and_one_reading_a_release():
    settings = StopwatchSettings(reaction_time=0.5)
    watch = Stopwatch(settings, 2, random_stream(0, 'stopwatch', 0))
    seen = []
    for start, motion in blocks(swing(SLOW, FORCING, 0.12, 1.0), 10.0):
        reading = watch.observe(start, motion)
        if reading:
            assert reading.pressed_at <= start + motion.duration
            seen.append(reading)
    assert len(seen) == 1


def test_fallen_pendulum_is_said_to_have_fallen():
    def falling(t):
        angle = np.minimum(0.12 * np.cosh(3.6 * np.maximum(t - 1.0, 0.0)), np.pi / 2)
        return angle, 1.0 * (angle < np.pi / 2), 0.0 * t

    (reading,) = readings(Stopwatch(IDEAL, 3, random_stream(0, 'stopwatch', 0)), blocks(falling, 6.0))
    assert (reading.kind, reading.displayed, reading.swings) == ('fell', 0.0, 0)


def test_swings_that_die_are_given_up_with_their_number():
    def dying(t):
        t = np.maximum(t - 1.0, 0.0)
        size = 0.12 * np.maximum(1 - t / 1.5, 0)
        return size * np.cos(SLOW * t), 0 * t, 0 * t

    (reading,) = readings(Stopwatch(IDEAL, 5, random_stream(0, 'stopwatch', 0)), blocks(dying, 20.0))
    assert (reading.kind, reading.swings) == ('stopped', 2)  # the passages were at 0.75, 1.75 and 2.75 periods
    assert reading.pressed_at < 8.0


def test_near_threshold_the_person_is_patient():
    slow = 2 * np.pi / 12.0
    (reading,) = readings(
        Stopwatch(IDEAL, 1, random_stream(0, 'stopwatch', 0)), blocks(swing(slow, FORCING, 0.1, 1.0), 40.0)
    )
    assert reading.displayed == pytest.approx(12.0, rel=1e-4)


def test_new_hold_abandons_the_timing_and_its_release_starts_another():
    held = 3.0

    def twice(t):
        first, second = swing(SLOW, FORCING, 0.12, 1.0), swing(SLOW, FORCING, 0.10, 4.0)
        return tuple(np.where(t[0] >= held - 1e-9, b, a) for a, b in zip(first(t), second(t), strict=True))

    (reading,) = readings(Stopwatch(IDEAL, 6, random_stream(0, 'stopwatch', 0)), blocks(twice, 10.0))
    assert reading.pressed_at == pytest.approx(4.0 + 6.75 * 2 * np.pi / SLOW, abs=1e-3)


def test_held_forever_and_already_swinging_give_nothing():
    held = swing(SLOW, FORCING, 0.12, 1e9)
    swinging = swing(SLOW, FORCING, 0.12, -5.0)
    for motion in (held, swinging):
        assert not readings(Stopwatch(IDEAL, 3, random_stream(0, 'stopwatch', 0)), blocks(motion, 20.0))


def test_other_samples_abandon_the_timing():
    """The filter of the eye knows one sample period."""
    motion = swing(SLOW, FORCING, 0.12, 1.0)
    coarse, fine = blocks(motion, 1.5), blocks(motion, 6.0, start=1.5, count=173, period=5e-4)
    assert not readings(Stopwatch(IDEAL, 3, random_stream(0, 'stopwatch', 0)), [*coarse, *fine])


def test_gap_in_the_motion_abandons_the_timing():
    steps = list(blocks(swing(SLOW, FORCING, 0.12, 1.0), 8.0))
    del steps[20]
    assert not readings(Stopwatch(IDEAL, 3, random_stream(0, 'stopwatch', 0)), steps)


def test_no_swings_are_refused():
    with pytest.raises(InstrumentError, match='one or more'):
        Stopwatch(IDEAL, 0, random_stream(0, 'stopwatch', 0))


def test_ended_reading_does_not_depend_on_later_samples():
    steps = list(blocks(swing(SLOW, FORCING, 0.12, 1.0), 6.0))
    whole = readings(Stopwatch(IDEAL, 3, random_stream(0, 'stopwatch', 0)), steps)
    end = next(i for i, (start, _) in enumerate(steps) if start > whole[0].pressed_at + 0.25)
    noise = SampledMotion(1e-3, np.linspace(0, 1, 101), np.zeros(101), np.zeros(101))
    changed = [*steps[:end], *((start, noise) for start, _ in steps[end:])]
    assert readings(Stopwatch(IDEAL, 3, random_stream(0, 'stopwatch', 0)), changed) == whole
