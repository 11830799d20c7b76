"""Quantities as people write them, turned into SI: `9.75in`, `37.3Hz`, `234rad/s`; a bare speed is in RPM."""

from __future__ import annotations

import math
import re
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pint

RPM = 2 * math.pi / 60
"""rad/s of one revolution a minute."""


_WRITTEN = re.compile(
    r'\s*(?P<number>[+-]?(?:\d+\.?\d*(?:e[+-]?\d+)?|\.\d+(?:e[+-]?\d+)?|inf(?:inity)?|nan))\s*(?P<unit>[a-zµ°]+(?:/[a-z]+)?)?\s*',
    re.IGNORECASE,
)


@cache
def _registry() -> pint.UnitRegistry[float]:
    """Build the registry at first use: it takes a third of a second, and most values come without a unit."""
    import pint  # noqa: PLC0415

    registry: pint.UnitRegistry[float] = pint.UnitRegistry(on_redefinition='ignore')
    # Pint counts hertz as 1/s, so that 1 Hz would be 1 rad/s; a shaft that turns at 1 Hz makes one turn a second.
    registry.define('hertz = turn / second = Hz')
    return registry


def _parse(text: str | float, si: str, bare: float) -> float:
    if isinstance(text, bool) or not isinstance(text, int | float | str):
        raise ValueError(f'{text!r} is not a number with a unit that converts to {si}')  # noqa: TRY004
    match = _WRITTEN.fullmatch(str(text))
    if match is None:
        raise ValueError(f'{text!r} is not a number with a unit that converts to {si}')
    if not match['unit']:
        return float(match['number']) * bare
    import pint  # noqa: PLC0415

    try:
        # Pint gets the unit alone: it would evaluate whatever else stood there.
        return float(match['number']) * float(_registry().Quantity(1.0, match['unit']).to(si).magnitude)
    except (pint.PintError, ValueError, TypeError, AttributeError, AssertionError) as error:
        raise ValueError(f'{text!r} is not a number with a unit that converts to {si}') from error


def parse_length(text: str | float) -> float:
    """Return metres; a bare number is in metres.

    Raises
    ------
    ValueError
        The text is not a length.

    """
    return _parse(text, 'm', 1.0)


def parse_speed(text: str | float) -> float:
    """Return rad/s; a bare number is in RPM.

    Raises
    ------
    ValueError
        The text is not a speed of rotation.

    """
    return _parse(text, 'rad/s', RPM)


def parse_frequency(text: str | float) -> float:
    """Return rad/s; a bare number is in Hz.

    Raises
    ------
    ValueError
        The text is not a frequency.

    """
    return _parse(text, 'rad/s', 2 * math.pi)


def parse_angle(text: str | float) -> float:
    """Return radians; a bare number is in radians.

    Raises
    ------
    ValueError
        The text is not an angle.

    """
    return _parse(text, 'rad', 1.0)
