from dataclasses import fields

import pytest
import yaml

from kapitsa_ros.configuration.files import shipped_names
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.instruments.errors import SettingsError
from kapitsa_ros.instruments.settings import Instruments
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.resources import resource_path


def test_1997_set_has_the_published_press():
    stopwatch = load_instruments('1997').stopwatch
    assert (stopwatch.reaction_time, stopwatch.reaction_jitter) == (0.11, 0.07)  # AJP 87, 110 (2019)


def test_ideal_set_neither_quantises_nor_reacts():
    ideal = load_instruments('ideal')
    assert ideal.strobe.dial_resolution == ideal.strobe.drift_limit == ideal.strobe.mark_width == 0
    assert ideal.stopwatch.reaction_time == ideal.stopwatch.reaction_jitter == ideal.stopwatch.display_resolution == 0


@pytest.mark.parametrize('name', shipped_names('instruments'))
def test_sets_name_every_parameter(name):
    text = resource_path('config', 'instruments', f'{name}.yaml').read_text()
    given = set(yaml.safe_load(text)['/**']['ros__parameters'])
    assert given == {field.name for kind in (StrobeSettings, StopwatchSettings) for field in fields(kind)}


def test_override_replaces():
    assert load_instruments('ideal', {'reaction_jitter': 0.1}).stopwatch.reaction_jitter == 0.1


@pytest.mark.parametrize(
    ('overrides', 'message'),
    [
        ({'reaction_jitter': -0.1}, 'must lie in'),
        ({'persistence': float('nan')}, 'finite'),
        ({'dial_resolution': 'ten'}, 'finite number'),
        ({'dial_resolution': True}, 'finite number'),
        ({'contrast_limit': 0.0}, 'must lie in'),
        ({'reaction_jiter': 0.1}, 'reaction_jiter'),
    ],
)
def test_bad_values_are_named(overrides, message):
    with pytest.raises(SettingsError, match=message):
        load_instruments('1997', overrides)


def test_unknown_set_is_refused():
    with pytest.raises(SettingsError, match='1998'):
        load_instruments('1998')


def test_flat_parameters_are_sorted_into_their_instruments():
    instruments = Instruments.of({'dial_resolution': 2.0, 'reaction_time': 0.2})
    assert instruments.strobe == StrobeSettings(dial_resolution=2.0)
    assert instruments.stopwatch == StopwatchSettings(reaction_time=0.2)
