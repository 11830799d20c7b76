"""Options that several commands share, and quantities with units."""

from __future__ import annotations

import functools
import json
import math
import pathlib
from typing import TYPE_CHECKING, Any

import click

from kapitsa_ros.analysis.assumptions import Assumptions
from kapitsa_ros.configuration import instrument_sets, presets
from kapitsa_ros.configuration.assignments import parse_assignments
from kapitsa_ros.configuration.files import shipped_names
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.rig_parameters import RigParameters
from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.instruments.settings import Instruments
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.recording.naming import run_folders
from kapitsa_ros.schema import describe
from kapitsa_ros.units import parse_angle, parse_frequency, parse_length, parse_quantity, parse_speed

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from kapitsa_ros.schema import Quantity


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


_RIG = {item.name: item for item in describe(RigParameters)}
RATE = _Rate(_RIG['rate'].low, _RIG['rate'].high)
"""Simulated over wall seconds."""
SEED = click.IntRange(int(_RIG['seed'].low), int(_RIG['seed'].high))


def _rate_option(default: float) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    return click.option(
        '--rate',
        type=RATE,
        default=default,
        show_default=True,
        help=_RIG['rate'].description,
    )


rate_option = _rate_option(0.0)
"""Adds --rate, for work that nobody watches."""
real_time_option = _rate_option(1.0)
"""Adds --rate, for people."""


class _Named(click.ParamType):  # type: ignore[type-arg]
    """A shipped file by its name, or another by its path; what is in it."""

    name = 'name or file'

    def __init__(self, load: Callable[[str], Any]) -> None:
        self._load = load

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not isinstance(value, str):
            return value
        try:
            return self._load(value)
        except KapitsaError as error:
            self.fail(str(error), param, ctx)


def _names(folder: str) -> str:
    return f'[{"|".join(shipped_names(folder))}|FILE]'


class _Assignment(click.ParamType):  # type: ignore[type-arg]
    """A value by its name, which a check refuses or lets pass."""

    name = 'NAME=VALUE'

    def __init__(self, check: Callable[[Mapping[str, Any]], Any]) -> None:
        self._check = check

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if isinstance(value, tuple):
            return value
        try:
            ((name, assigned),) = parse_assignments([value]).items()
            self._check({name: assigned})
        except KapitsaError as error:
            self.fail(str(error), param, ctx)
        return name, assigned


def plant_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --preset and its overrides; the command gets `plant`, a Plant."""
    quantities = describe(Plant)

    @functools.wraps(command)
    def with_plant(*args: Any, preset: Plant, **kwargs: Any) -> Any:
        overrides = {item.name: kwargs.pop(item.name) for item in quantities}
        plant = preset.replaced({name: value for name, value in overrides.items() if value is not None})
        return command(*args, plant=plant, **kwargs)

    for item in reversed(quantities):
        described = ', '.join(filter(None, (item.description, item.symbol, '' if item.unit == 'm' else item.unit)))
        with_plant = click.option(
            f'--{item.name.replace("_", "-")}',
            item.name,
            type=LENGTH if item.unit == 'm' else _number(item),
            help=f'{described} (overrides the preset)',
        )(with_plant)
    return click.option(
        '--preset',
        type=_Named(load_preset),
        metavar=_names(presets.FOLDER),
        default='ideal',
        show_default=True,
        help='the plant',
    )(with_plant)


def _number(item: Quantity) -> _Quantity:
    example = f'{item.default:g} {item.unit}'.strip()
    return _Quantity('float', functools.partial(parse_quantity, unit=item.unit), example)


def instrument_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --instruments and --instrument, its overrides; the command gets `instruments`."""

    @functools.wraps(command)
    def with_instruments(
        *args: Any, instruments: Instruments, overrides: Sequence[tuple[str, str]], **kwargs: Any
    ) -> Any:
        return command(*args, instruments=instruments.replaced(dict(overrides)), **kwargs)

    with_instruments = click.option(
        '--instrument',
        'overrides',
        type=_Assignment(Instruments.of),
        multiple=True,
        help='a parameter of an instrument, in SI or with a unit (overrides the set; several may be given)',
    )(with_instruments)
    return click.option(
        '--instruments',
        type=_Named(load_instruments),
        metavar=_names(instrument_sets.FOLDER),
        default='1997',
        show_default=True,
        help='how readings err',
    )(with_instruments)


def assumption_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --assume; the command gets `assumptions`."""

    @functools.wraps(command)
    def with_assumptions(*args: Any, assumed: Sequence[tuple[str, str]], **kwargs: Any) -> Any:
        return command(*args, assumptions=Assumptions.of(dict(assumed)), **kwargs)

    return click.option(
        '--assume',
        'assumed',
        type=_Assignment(Assumptions.of),
        multiple=True,
        help='what is taken for granted of rod and instruments, as in stopwatch_rate_u=0.02 (several may be given)',
    )(with_assumptions)


def composed_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --composed; the command gets `composed`."""
    meaning = 'all nodes in one process, which takes less of the machine; the bags are the same'
    return click.option('--composed', is_flag=True, help=meaning)(command)


def budget_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --budget; the command gets `with_budget`."""
    return click.option(
        '--budget',
        'with_budget',
        is_flag=True,
        help='also what each input contributes to the uncertainty of the critical speed',
    )(command)


def overwrite_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --overwrite; the command gets `overwrite`."""
    return click.option('--overwrite', is_flag=True, help='replace files that are there already')(command)


def json_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --json; the command gets `as_json`."""
    return click.option('--json', 'as_json', is_flag=True, help='print one JSON object on stdout')(command)


def bags_argument(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add BAGS, runs or folders of runs; the command gets `bags`, the runs."""

    def expanded(_context: click.Context, _parameter: click.Parameter, bags: tuple[Path, ...]) -> tuple[Path, ...]:
        return run_folders(bags)

    return click.argument('bags', nargs=-1, required=True, type=click.Path(path_type=pathlib.Path), callback=expanded)(
        command
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
