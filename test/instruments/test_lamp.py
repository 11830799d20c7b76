import math
from fractions import Fraction

import numpy as np
import pytest

from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.instruments.errors import InstrumentError
from kapitsa_ros.instruments.lamp import AFTERIMAGE, Lamp
from kapitsa_ros.instruments.strobe_images import standing_images
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.physics.jigsaw import Jigsaw
from kapitsa_ros.physics.jigsaw_parameters import JigsawParameters
from kapitsa_ros.units import RPM

SPEED = 2500 * RPM
AMPLITUDE = 0.0127
STEP = 0.1
EYE = StrobeSettings(mark_width=0.01)


class Bench:
    """A shaft that turns at one speed, from a phase at time 0, and a lamp over its mark."""

    def __init__(self, eye=EYE, phase=0.0):
        self.lamp = Lamp(eye, AMPLITUDE)
        run_up = 0.01  # s
        parameters = JigsawParameters(phase=phase - SPEED * run_up / 2, spin_up=1e5)
        self._shaft = Jigsaw(amplitude=AMPLITUDE, parameters=parameters)
        self._shaft.advance(SPEED, run_up, 1)
        self._time = 0.0

    def run(self, steps):
        for _ in range(steps):
            self.lamp.shine(self._time, self._shaft.advance(SPEED, STEP, 100))
            self._time += STEP

    def seen(self):
        return self.lamp.picture(self._time)


@pytest.mark.parametrize('phase', [0.3, 1.234, 4.0])
@pytest.mark.parametrize('ratio', [Fraction(p, q) for p in (1, 2, 3, 4) for q in (1, 2, 3) if math.gcd(p, q) == 1])
def test_at_a_ratio_of_the_true_speed_the_images_are_those_of_the_theory(ratio, phase):
    bench = Bench(phase=phase)
    bench.lamp.turn(float(ratio) * SPEED)
    bench.run(3)
    heights, shares = bench.seen()
    theory, _ = standing_images(ratio.numerator, phase, EYE.mark_width)
    assert heights == pytest.approx(theory, abs=2e-3)
    assert shares.sum() == pytest.approx(1)
    if ratio == 2:
        assert heights.size == 2


@pytest.mark.parametrize(('detuning', 'way'), [(0.001, -1), (-0.001, 1), (0.0, 0)])
def test_beside_the_speed_the_image_creeps_against_the_detuning(detuning, way):
    """On the upstroke, a lamp that flashes too fast lights the mark ever earlier, and lower."""
    bench = Bench(load_instruments('1997').strobe, phase=math.pi / 2)
    bench.lamp.turn((1 + detuning) * SPEED)
    bench.run(2)
    before, _ = bench.seen()
    bench.run(2)
    after, _ = bench.seen()
    assert before.size == after.size == 1
    # dφ/dt = ω − flash rate, and the height is −cos φ near φ = π/2. The eye has seen a whole number of flashes.
    a_flash = 2 * math.pi * abs(detuning)
    assert after[0] - before[0] == pytest.approx(-detuning * SPEED * 2 * STEP, abs=a_flash + 1e-6)
    assert np.sign(np.round(after[0] - before[0], 3)) == way


def test_far_from_any_ratio_there_is_a_blur():
    bench = Bench()
    bench.lamp.turn(1.7321 * SPEED)
    bench.run(3)
    _, shares = bench.seen()
    assert shares.size > 5
    assert shares.max() <= EYE.contrast_limit + 0.1


def test_an_error_of_the_dial_shows_in_the_picture():
    bench = Bench(StrobeSettings(mark_width=0.01, dial_error=0.02))
    bench.lamp.turn(2 * 1.02 * SPEED)
    assert bench.lamp.flash_rate == pytest.approx(2 * SPEED)
    bench.run(3)
    assert bench.seen()[0].size == 2


def test_turning_the_dial_takes_over_from_the_last_flash():
    bench = Bench(phase=0.7)
    bench.lamp.turn(2 * SPEED)
    bench.run(3)
    assert bench.seen()[0].size == 2
    bench.lamp.turn(SPEED)
    bench.run(3)
    heights, _ = bench.seen()
    assert heights.size == 1
    assert min(abs(heights[0] + math.cos(phase)) for phase in (0.7, 0.7 + math.pi)) < 2e-3


def test_it_is_dark_without_the_lamp_between_slow_flashes_and_after_a_gap():
    bench = Bench()
    bench.run(2)
    assert not bench.seen()[0].size
    bench.lamp.turn(2 * math.pi / 1.0)  # one flash a second
    bench.run(10)
    assert not bench.seen()[0].size
    bench.run(1)
    assert bench.lamp.picture(1.2 + AFTERIMAGE / 2)[0].size == 1
    bench.lamp.turn(SPEED)
    bench.run(1)
    assert bench.seen()[0].size
    bench._time += 50.0
    bench.lamp.turn(0.0)
    bench.run(1)
    assert not bench.lamp.picture(1.3)[0].size


def test_the_dial_has_ends():
    lamp = Lamp(EYE, AMPLITUDE)
    for wrong in (-1.0, EYE.dial_end * 1.01, math.nan, math.inf):
        with pytest.raises(InstrumentError, match='25000 a minute'):
            lamp.turn(wrong)
