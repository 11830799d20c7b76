"""An unknown override is an error of its set (D14), and assignments are read from text."""

import pytest

from kapitsa_ros.configuration.assignments import parse_assignments
from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.step_parameters import StepParameters
from kapitsa_ros.instruments.errors import SettingsError
from kapitsa_ros.physics.errors import ParameterError


def test_an_unknown_override_of_a_preset_is_a_parameter_error():
    with pytest.raises(ParameterError, match='lenght'):
        load_preset('ideal', {'lenght': 1.0})


def test_an_unknown_override_of_instruments_is_a_settings_error():
    with pytest.raises(SettingsError, match='reaction_tim'):
        load_instruments('1997', {'reaction_tim': 1.0})


def test_assignments():
    assert parse_assignments(['a=1', ' b = 2 in ', 'a=3']) == {'a': '3', 'b': '2 in'}


@pytest.mark.parametrize('text', ['a', '=1', 'a=', ''])
def test_what_is_no_assignment(text):
    with pytest.raises(ConfigurationError, match='NAME=VALUE'):
        parse_assignments([text])


def test_steps_hold_whole_samples():
    assert StepParameters().samples == 100
    with pytest.raises(ConfigurationError, match='whole samples'):
        _ = StepParameters(sample_rate=999.0).samples
