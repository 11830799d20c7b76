import numpy as np
import pytest
from motions import blocks, shaft

from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.instruments.random_streams import random_stream
from kapitsa_ros.instruments.strobe import Strobe
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.units import RPM


def readings(strobe, steps):
    return [reading for start, pivot in steps if (reading := strobe.observe(start, pivot)) is not None]


@pytest.mark.parametrize('rod_ratio', [np.inf, 4.0])
@pytest.mark.parametrize('rpm', [437.0, 1354.8, 2240.0, 2500.0, 3990.0])
@pytest.mark.parametrize('block', [{}, {'count': 53}, {'count': 130}, {'count': 200, 'period': 5e-4}])
def test_ideal_strobe_reads_the_shaft_to_nine_digits(rpm, block, rod_ratio):
    steps = blocks(shaft(rpm * RPM, 0.7, rod_ratio), 6.0, start=100.0, **block)
    (reading,) = readings(Strobe(load_instruments('ideal').strobe, random_stream(1, 'strobe', 0)), steps)
    assert reading.speed == pytest.approx(rpm * RPM, rel=1e-9)


def test_1997_reading_is_a_graduation_near_the_truth():
    rpm = [
        readings(
            Strobe(load_instruments('1997').strobe, random_stream(seed, 'strobe', 0)), blocks(shaft(2503 * RPM), 40.0)
        )[0].speed
        / RPM
        for seed in range(40)
    ]
    assert np.abs(np.array(rpm) / 10 - np.round(np.array(rpm) / 10)).max() < 1e-9
    trusted = np.array([value for value in rpm if abs(value - 2503) < 100])
    assert trusted.size > 25  # the others were fooled
    assert 1 < np.abs(trusted - 2503).max() <= 5 + 6 + 1  # half a graduation and the drift not noticed
    assert abs(trusted.mean() - 2503) < 4 * trusted.std() / np.sqrt(trusted.size)


def test_one_reading_a_steady_speed_and_none_while_it_changes():
    ramp_end, first, second = 5.0, 2240 * RPM, 2640 * RPM
    rate = (second - first) / 1.0

    def motion(t):
        ramp = np.clip(t - ramp_end, 0.0, 1.0)
        phi = first * t + rate * ramp**2 / 2 + (second - first) * np.maximum(t - ramp_end - 1.0, 0.0)
        speed, turn = first + rate * ramp, rate * ((t > ramp_end) & (t < ramp_end + 1))
        return -np.cos(phi), speed * np.sin(phi), speed**2 * np.cos(phi) + turn * np.sin(phi)

    seen = readings(Strobe(load_instruments('ideal').strobe, random_stream(1, 'strobe', 0)), blocks(motion, 12.0))
    assert [reading.speed for reading in seen] == pytest.approx([first, second], rel=1e-9)
    assert seen[0].time < ramp_end < ramp_end + 1 < seen[1].time


def test_reading_is_taken_within_the_step_that_returns_it_and_takes_seconds():
    strobe = Strobe(load_instruments('1997').strobe, random_stream(3, 'strobe', 0))
    for start, pivot in blocks(shaft(2500 * RPM), 10.0):
        reading = strobe.observe(start, pivot)
        if reading is not None:
            assert start < reading.time <= start + pivot.duration
            assert 1.0 < reading.time < 10.0
            return
    pytest.fail('no reading')


def test_resting_shaft_gives_nothing():
    still = SampledMotion(1e-3, -np.ones(101), np.zeros(101), np.zeros(101))
    strobe = Strobe(load_instruments('1997').strobe, random_stream(3, 'strobe', 0))
    assert not any(strobe.observe(0.1 * step, still) for step in range(100))


def test_shaft_too_fast_for_the_lamp_gives_nothing():
    slow_lamp = StrobeSettings(dial_end=300.0)
    assert not readings(Strobe(slow_lamp, random_stream(3, 'strobe', 0)), blocks(shaft(2500 * RPM), 20.0))


def test_dial_error_scales_the_reading():
    wrong = StrobeSettings(dial_error=0.02)
    (reading,) = readings(Strobe(wrong, random_stream(1, 'strobe', 0)), blocks(shaft(2500 * RPM), 6.0))
    assert reading.speed == pytest.approx(1.02 * 2500 * RPM, rel=1e-9)
