import math
from fractions import Fraction

import numpy as np
import pytest

from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.instruments.dial_search import raise_until_doubled, read_dial, standing_ratios
from kapitsa_ros.instruments.random_streams import random_stream
from kapitsa_ros.instruments.strobe_images import faintest, standing_images
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.units import RPM

SPEED = 2500 * RPM
EYE = StrobeSettings()
OF_1997 = load_instruments('1997').strobe


def flashed(p, q, phase):
    """Return the distinct heights of a mark at −cos φ, by letting the lamp flash a hundred times."""
    phases = phase + 2 * math.pi * q / p * np.arange(100)
    return np.unique(np.round(-np.cos(phases), 6))


@pytest.mark.parametrize('phase', [0.3, 1.234, 4.0])
@pytest.mark.parametrize('q', range(1, 6))
@pytest.mark.parametrize('p', range(1, 6))
def test_flashes_at_any_ratio_show_the_images_that_physics_gives(p, q, phase):
    heights, shares = standing_images(Fraction(p, q).numerator, phase, EYE.mark_width)
    assert heights == pytest.approx(flashed(p, q, phase), abs=1e-5)
    assert shares.sum() == pytest.approx(1)


@pytest.mark.parametrize(
    ('ratio', 'phase', 'images'),
    [
        (Fraction(1), 0.7, 1),
        (Fraction(1, 2), 0.7, 1),
        (Fraction(1, 3), 0.7, 1),
        (Fraction(2), 0.7, 2),
        (Fraction(2, 3), 0.7, 2),
        (Fraction(2, 5), 0.7, 2),
        (Fraction(2), math.pi / 2, 1),  # can look single
        (Fraction(3), 0.0, 2),  # can look doubled
        (Fraction(3, 2), math.pi / 3, 2),
        (Fraction(4, 3), math.pi / 4, 2),
        (Fraction(4, 3), 0.0, 3),
        (Fraction(3), 0.7, 3),
    ],
)
def test_special_phases_fool_the_eye(ratio, phase, images):
    assert standing_images(ratio.numerator, phase, EYE.mark_width)[0].size == images


def test_share_of_the_flashes_is_the_contrast():
    heights, shares = standing_images(3, 0.0, 0.0)
    assert heights == pytest.approx([-1, 0.5])
    assert shares == pytest.approx([1 / 3, 2 / 3])


def test_images_nearer_than_the_mark_is_wide_look_like_one():
    width = 0.04
    for offset, images in ((0.9 * width, 1), (1.1 * width, 2)):  # at 2ω they stand 2|cos φ| amplitudes apart
        assert standing_images(2, math.pi / 2 + offset, width)[0].size == images


def test_images_of_many_phases_are_too_faint_to_be_seen():
    assert faintest(StrobeSettings(contrast_limit=0.2)) == 5
    assert faintest(StrobeSettings(contrast_limit=1 / 6)) == 6


def test_standing_ratios_are_those_with_few_phases():
    assert standing_ratios(1.0, 2.0, 4) == [Fraction(4, 3), Fraction(3, 2), Fraction(2)]


def findings(settings, seeds=400):
    return [raise_until_doubled(SPEED, settings, random_stream(seed, 'strobe', 1)) for seed in range(seeds)]


def test_ideal_eye_is_never_fooled():
    assert {finding.ratio for finding in findings(load_instruments('ideal').strobe)} == {Fraction(2)}


def test_person_of_1997_is_fooled_now_and_then_and_by_what_can_look_doubled():
    ratios = [finding.ratio for finding in findings(OF_1997)]
    fooled = [ratio for ratio in ratios if ratio != 2]
    assert 0.01 < len(fooled) / len(ratios) < 0.12
    assert {Fraction(3, 2), Fraction(4, 3)} <= set(fooled)
    assert all(ratio.numerator in (2, 3, 4) for ratio in fooled)


def test_wider_marks_fool_more():
    shares = []
    for width in (0.02, 0.1):
        settings = load_instruments('1997', {'mark_width': width}).strobe
        shares.append(np.mean([finding.ratio != 2 for finding in findings(settings)]))
    assert shares[0] < shares[1]


def test_search_that_starts_below_the_speed_stops_at_two_thirds():
    low = load_instruments('1997', {'guess_error': 0.3}).strobe
    assert Fraction(2, 3) in {finding.ratio for finding in findings(low)}


def test_lamp_that_ends_too_early_finds_nothing():
    assert raise_until_doubled(SPEED, StrobeSettings(dial_end=1.9 * SPEED), random_stream(1, 'strobe', 1)) is None


def test_dial_is_read_to_its_nearest_graduation_and_halved():
    settings = StrobeSettings(dial_resolution=2.0, dial_error=0.01)
    assert read_dial(100.0, settings) == 50.0  # shows 101: halfway goes to the even graduation
    assert read_dial(100.2, settings) == 51.0
