"""Quantities as people write them."""

import math

import pytest

from kapitsa_ros.units import RPM, parse_angle, parse_frequency, parse_length, parse_speed


@pytest.mark.parametrize(
    ('parse', 'text', 'value'),
    [
        (parse_length, '9.75in', 0.24765),
        (parse_length, '9.75 inches', 0.24765),
        (parse_length, '0.2mm', 2e-4),
        (parse_length, '30 µm', 3e-5),
        (parse_length, '30um', 3e-5),
        (parse_length, '1 ft', 0.3048),
        (parse_length, '2 metres', 2.0),
        (parse_length, 0.25, 0.25),
        (parse_speed, '2500', 2500 * RPM),
        (parse_speed, '2500 RPM', 2500 * RPM),
        (parse_speed, '2500rpm', 2500 * RPM),
        (parse_speed, '10 Hz', 20 * math.pi),
        (parse_speed, '10 hertz', 20 * math.pi),
        (parse_speed, '234rad/s', 234.0),
        (parse_speed, '1 turn/s', 2 * math.pi),
        (parse_speed, '60 rev/min', 2 * math.pi),
        (parse_speed, '180 deg/s', math.pi),
        (parse_speed, '60 revolutions_per_minute', 2 * math.pi),
        (parse_frequency, 45, 90 * math.pi),
        (parse_angle, '0.12', 0.12),
        (parse_angle, '180 degrees', math.pi),
        (parse_angle, '180°', math.pi),
    ],
)
def test_units(parse, text, value):
    assert parse(text) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ('parse', 'text', 'si'),
    [
        (parse_length, '3 kg', 'm'),
        (parse_length, '3 rad', 'm'),
        (parse_length, '3 Mm', 'm'),
        (parse_length, '9**9**9 m', 'm'),
        (parse_length, '', 'm'),
        (parse_length, True, 'm'),
        (parse_speed, '3 in', 'rad/s'),
        (parse_speed, '3 rad', 'rad/s'),
        (parse_angle, '3 rpm', 'rad'),
    ],
)
def test_what_is_of_another_dimension_is_refused(parse, text, si):
    with pytest.raises(ValueError, match=f'is not a number with a unit that converts to {si}$'):
        parse(text)
