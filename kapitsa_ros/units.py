"""Quantities as people write them, turned into SI: `9.75in`, `37.3Hz`, `234rad/s`; a bare speed is in RPM."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from kapitsa_ros.errors import QuantityError

if TYPE_CHECKING:
    from collections.abc import Callable

RPM = 2 * math.pi / 60
"""rad/s of one revolution a minute."""
NORMAL_95 = 1.959964
"""Standard uncertainties to either end of a 95 % interval of a normal distribution."""

_WRITTEN = re.compile(
    r'\s*(?P<number>[+-]?(?:\d+\.?\d*(?:e[+-]?\d+)?|\.\d+(?:e[+-]?\d+)?|inf(?:inity)?|nan))\s*(?P<unit>\S.*?)?\s*',
    re.IGNORECASE,
)
_INCH = Fraction(254, 10_000)  # exact: 9.75in is the double next to 0.24765 m
INCH = float(_INCH)
"""m."""
_TURN = 2 * math.pi
_NAMES: dict[str, tuple[tuple[float | Fraction, str], ...]] = {
    'm': (
        (Fraction(1), 'm metre metres meter meters'),
        (Fraction(1, 10), 'dm'),
        (Fraction(1, 100), 'cm centimetre centimetres centimeter centimeters'),
        (Fraction(1, 1000), 'mm millimetre millimetres millimeter millimeters'),
        (Fraction(1, 10**6), 'µm μm um micrometre micrometres micrometer micrometers micron microns'),
        (Fraction(1000), 'km kilometre kilometres kilometer kilometers'),
        (_INCH / 1000, 'thou mil'),
        (_INCH, 'in inch inches'),
        (12 * _INCH, 'ft foot feet'),
        (36 * _INCH, 'yd yard yards'),
    ),
    'rad': (
        (Fraction(1), 'rad radian radians'),
        (Fraction(1, 1000), 'mrad'),
        (math.pi / 180, 'deg degree degrees °'),
        (_TURN, 'turn turns rev revolution revolutions'),
    ),
    's': (
        (Fraction(1), 's sec second seconds'),
        (Fraction(1, 1000), 'ms millisecond milliseconds'),
        (Fraction(1, 10**6), 'µs μs us microsecond microseconds'),
        (Fraction(60), 'min minute minutes'),
    ),
    # A shaft that turns at 1 Hz makes one turn a second.
    'rad/s': (
        (RPM, 'rpm revolutions_per_minute'),
        (_TURN, 'Hz hertz rps revolutions_per_second'),
        (1e3 * _TURN, 'kHz kilohertz'),
    ),
    'Hz': ((Fraction(1), 'Hz hertz'), (Fraction(1000), 'kHz kilohertz')),
}
_EXACT = {unit: {name: factor for factor, names in table for name in names.split()} for unit, table in _NAMES.items()}
_EXACT['rad/s'] |= {
    f'{angle}/{time}': turned / taken for angle, turned in _EXACT['rad'].items() for time, taken in _EXACT['s'].items()
}
# In a short name the case may tell a prefix from another: no Mm is a mm.
_FOLDED = {
    unit: {name.lower(): factor for name, factor in names.items() if len(name) > 2 or name == 'Hz'}
    for unit, names in _EXACT.items()
}


def counted(number: int, noun: str) -> str:
    """Return a number of things in words: 1 run, 3 runs."""
    return f'{number} {noun}{"" if number == 1 else "s"}'


def in_rpm(speed: float | None) -> float | None:
    """Return a speed in rad/s as revolutions a minute; None where there is none, or nan."""
    return None if speed is None or math.isnan(speed) else speed / RPM


def interval_text(interval: tuple[float | None, float | None], end_text: Callable[[float], str]) -> str:
    """Return both ends of an interval; one that is None is unbounded."""
    return ' to '.join('unbounded' if end is None else end_text(end) for end in interval)


def is_within(value: float, interval: tuple[float | None, float | None]) -> bool:
    """Tell whether an interval holds a value; an end that is None is unbounded and excludes nothing."""
    low, high = interval
    return (low is None or low <= value) and (high is None or value <= high)


def digits_of(u: float) -> int:
    """Return how many decimals a standard uncertainty lets a value have: those of its first two digits (GUM 7.2.6)."""
    if not (math.isfinite(u) and u > 0.0):
        return 0
    return max(0, 1 - math.floor(math.log10(u)))


def decimals_within(interval: tuple[float | None, float | None], unit: float = 1.0) -> int:
    """Return how many decimals a value has, in a unit, by its 95 % interval; none where an end is unbounded."""
    low, high = interval
    return 0 if low is None or high is None else digits_of((high - low) / (2.0 * NORMAL_95 * unit))


def parse_quantity(text: str | float, unit: str, bare: float | Fraction = Fraction(1)) -> float:
    """Return a quantity in an SI unit.

    Parameters
    ----------
    text
        A number, or a text of a number and perhaps a unit.
    unit
        The SI unit; m, rad, s and rad/s may be written in others of their dimension, the rest as they are.
    bare
        What a number without a unit is multiplied by.

    Raises
    ------
    QuantityError
        It is no number, or its unit does not convert.

    """
    match = None if isinstance(text, bool) or not isinstance(text, int | float | str) else _WRITTEN.fullmatch(str(text))
    factor = _factor(match['unit'], unit, bare) if match else None
    if match is None or factor is None:
        raise (
            QuantityError('{text!r} is not a number with a unit that converts to {unit}', text=text, unit=unit)
            if unit
            else QuantityError('{text!r} is not a number without unit', text=text)
        )
    number = float(match['number'])
    if isinstance(factor, Fraction) and number and math.isfinite(number):
        return float(Fraction(match['number']) * factor)  # rounded once: 9.75in is 0.24765 m
    return number * factor


def written_unit(text: str, unit: str) -> tuple[str, float] | None:
    """Return the unit that a quantity is written with, and how much of the SI unit it is; None without one."""
    match = _WRITTEN.fullmatch(text)
    factor = _factor(match['unit'], unit, 1.0) if match and match['unit'] else None
    return (match['unit'], float(factor)) if match and factor is not None else None


def _factor(written: str | None, unit: str, bare: float | Fraction) -> float | Fraction | None:
    if not written:
        return bare
    if _plain(written) == _plain(unit):
        return Fraction(1)
    exact = _EXACT.get(unit, {}).get(written)
    return _FOLDED.get(unit, {}).get(written.lower()) if exact is None else exact


def _plain(unit: str) -> str:
    return unit.replace(' ', '').replace('²', '^2').replace('**', '^').replace('·', '*')


def is_quantity(value: Any) -> bool:
    """Tell whether a value is a quantity of a library of units."""
    return hasattr(value, 'to') and hasattr(value, 'magnitude')


def magnitude(value: Any, unit: str) -> Any:
    """Return a quantity of a library of units in an SI unit; what cannot be converted raises as the library does.

    Pint counts hertz as 1/s and so 1 Hz as 1 rad/s; a shaft that turns at 1 Hz makes one turn a second.
    """
    turns = unit.startswith('rad/s') and any(word in str(value.units) for word in ('hertz', 'Hz'))
    return value.to(unit.replace('²', '^2').replace('·', '*')).magnitude * (_TURN if turns else 1)


def parse_length(text: str | float) -> float:
    """Return metres; a bare number is in metres.

    Raises
    ------
    QuantityError
        The text is not a length.

    """
    return parse_quantity(text, 'm')


def parse_speed(text: str | float) -> float:
    """Return rad/s; a bare number is in RPM.

    Raises
    ------
    QuantityError
        The text is not a speed of rotation.

    """
    return parse_quantity(text, 'rad/s', RPM)


def parse_frequency(text: str | float) -> float:
    """Return rad/s; a bare number is in Hz.

    Raises
    ------
    QuantityError
        The text is not a frequency.

    """
    return parse_quantity(text, 'rad/s', _TURN)


def parse_angle(text: str | float) -> float:
    """Return radians; a bare number is in radians.

    Raises
    ------
    QuantityError
        The text is not an angle.

    """
    return parse_quantity(text, 'rad')
