"""Options that several commands share, and quantities with units."""

from __future__ import annotations

import functools
import json
import math
from typing import TYPE_CHECKING, Any

import click

from kapitsa_ros.instruments.settings import INSTRUMENT_SETS
from kapitsa_ros.physics.plant import PRESETS, load_preset
from kapitsa_ros.units import parse_angle, parse_frequency, parse_length, parse_speed

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path


class _Quantity(click.ParamType):  # type: ignore[type-arg]
    def __init__(self, name: str, parse: Callable[[str | float], float], example: str) -> None:
        self.name = name
        self._parse = parse
        self._example = example

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        try:
            number = self._parse(value)
        except ValueError as error:
            self.fail(f'{error}; write it as in {self._example}', param, ctx)
        if not math.isfinite(number):
            self.fail(f'{value!r} is not finite; write it as in {self._example}', param, ctx)
        return number


LENGTH = _Quantity('length', parse_length, '0.25, 9.75in or 0.2mm')
"""Metres."""
SPEED = _Quantity('speed', parse_speed, '2240, 37.3Hz or 234rad/s')
"""rad/s; a bare number is RPM."""
FREQUENCY = _Quantity('frequency', parse_frequency, '45, 45Hz or 283rad/s')
"""rad/s; a bare number is Hz."""
ANGLE = _Quantity('angle', parse_angle, '0.12 or 7deg')
"""Radians."""


class _Rate(click.FloatRange):
    """Click's range lets NaN through."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f'{value!r} is not finite; 1 is real time, 0 as fast as it can', param, ctx)
        return number


RATE = _Rate(0, 1e4)
"""Simulated over wall seconds."""
SEED = click.IntRange(0, 2**63 - 1)


def _rate_option(default: float) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    return click.option(
        '--rate',
        type=RATE,
        default=default,
        show_default=True,
        help='simulated over wall seconds; 0: as fast as it can',
    )


rate_option = _rate_option(0.0)
"""Adds --rate, for work that nobody watches."""
real_time_option = _rate_option(1.0)
"""Adds --rate, for people."""


_PLANT_OPTIONS: tuple[tuple[str, Any, str], ...] = (
    ('length', LENGTH, 'length of the rod, L'),
    ('amplitude', LENGTH, 'half the stroke of the pivot, λ'),
    ('gravity', float, 'g, m/s²'),
    ('damping', float, 'viscous friction c, 1/s'),
    ('coulomb', float, 'Coulomb friction f, rad/s²'),
    ('clearance', LENGTH, 'diametral play of the pivot hole, D'),
    ('restitution', float, 'restitution of impacts within the play, e'),
    ('inertia_factor', float, 'κ in k = κ·3/(2L)'),
    ('wear', float, 'growth of the clearance, m per J/kg that impacts lose'),
    ('failure_clearance', LENGTH, 'play at which the hole has worn through'),
)


def plant_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --preset and its overrides; the command gets `plant`, a PlantParameters."""

    @functools.wraps(command)
    def with_plant(*args: Any, preset: str, **kwargs: Any) -> Any:
        overrides = {name: kwargs.pop(name) for name, _, _ in _PLANT_OPTIONS}
        return command(*args, plant=load_preset(preset, _given(overrides)), **kwargs)

    for name, kind, text in reversed(_PLANT_OPTIONS):
        with_plant = click.option(
            f'--{name.replace("_", "-")}', name, type=kind, help=f'{text} (overrides the preset)'
        )(with_plant)
    return click.option('--preset', type=click.Choice(PRESETS), default='ideal', show_default=True, help='the plant')(
        with_plant
    )


def instrument_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --instruments; the command gets the name of a set."""
    return click.option(
        '--instruments', type=click.Choice(INSTRUMENT_SETS), default='1997', show_default=True, help='how readings err'
    )(command)


def json_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --json; the command gets `as_json`."""
    return click.option('--json', 'as_json', is_flag=True, help='print one JSON object on stdout')(command)


def warn_of_repeats(bags: Sequence[Path]) -> None:
    """Say so where a bag is given twice: its readings count twice, and the interval is too narrow."""
    places = [path.resolve() for path in bags]
    for place in sorted({place for place in places if places.count(place) > 1}):
        click.echo(
            f'kapitsa: warning: {place.name} is given more than once: its readings count each time, which makes the '
            'interval too narrow',
            err=True,
        )


def print_json(values: Mapping[str, Any]) -> None:
    """Print one JSON object; a number that does not exist is null."""
    click.echo(json.dumps(_plain(values), allow_nan=False))


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if hasattr(value, 'item'):  # numpy's scalars
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _given(overrides: Mapping[str, float | None]) -> dict[str, float]:
    return {name: value for name, value in overrides.items() if value is not None}
