"""A class: how many benches, and what rod stands on each. A YAML file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kapitsa_ros.analysis.ruler import RULER_SIGMA
from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.configuration.files import read_mapping
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.instruments.random_streams import random_stream
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.schema import ParameterSet, describe, quantity

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.schema import Quantity

MOST_BENCHES = 99
_RODS: Mapping[str, Any] = {
    'length': {'from': 0.2, 'to': 0.3},
    'amplitude': {'from': 0.011, 'to': 0.014},
    'damping': {'from': 0.0, 'to': 0.1},
    'coulomb': {'from': 0.0, 'to': 0.5},
    'clearance': {'from': 0.0, 'to': 0.0002},
    'inertia_factor': {'from': 0.8, 'to': 1.0},
}
"""Where the file names none."""
_SHORTEST = 1e-3
"""m; no ruler says less of a rod."""


@dataclass(frozen=True, kw_only=True)
class ClassNumbers(ParameterSet):
    """What of a class is a number."""

    error = ConfigurationError

    benches: int = quantity(30, '', 1, MOST_BENCHES, description='benches')
    seed: int = quantity(1, '', 0, 2**62, description='of the rods, and of all chance at the benches')
    rate: float = quantity(1.0, '', 0.125, 32.0, description='simulated over wall seconds, until a student changes it')
    fastest_rate: float = quantity(8.0, '', 0.125, 32.0, description='to which a student may change that')
    ruler_error: float = quantity(
        0.0005, 'm', 0.0, 0.1, description='standard uncertainty of the length that a student is told'
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.rate > self.fastest_rate:
            raise ConfigurationError(f'rate is {self.rate:g}: it must be at most fastest_rate ({self.fastest_rate:g})')


@dataclass(frozen=True, kw_only=True)
class SealedRod:
    """What stands on a bench, and what its student is told of that."""

    plant: Plant
    told_length: float
    """m; the ruler's word."""


@dataclass(frozen=True, kw_only=True)
class ClassSettings:
    """A class."""

    numbers: ClassNumbers
    plant: Plant
    """What of the rods is not drawn."""
    drawn: Mapping[str, tuple[float, float]]
    """By parameter of the plant: the ends between which it is drawn evenly; SI."""
    instruments: Instruments

    def rod(self, bench: int) -> SealedRod:
        """Return the rod of a bench, by its number from 1: always the same."""
        chance = random_stream(self.numbers.seed, 'rod', bench)
        shares = {item.name: float(chance.random()) for item in describe(Plant)}
        plant = self.plant.replaced(
            {name: low + shares[name] * (high - low) for name, (low, high) in self.drawn.items()}
        )
        told = plant.length + self.numbers.ruler_error * float(chance.standard_normal())
        return SealedRod(plant=plant, told_length=max(told, _SHORTEST))

    @property
    def told_amplitude(self) -> tuple[float, float]:
        """What everybody knows of the stroke: the mean of its half and the standard uncertainty, m."""
        low, high = self.drawn.get('amplitude', (self.plant.amplitude,) * 2)
        return 0.5 * (low + high), max((high - low) / math.sqrt(12.0), RULER_SIGMA)

    @property
    def identity(self) -> str:
        """The same for classes with the same rods."""
        return repr((self.numbers.seed, self.numbers.ruler_error, self.plant, sorted(self.drawn.items())))


def load_class(path: Path) -> ClassSettings:
    """Read a class.

    `benches`, `seed`, `rate`, `fastest_rate` and `ruler_error` are numbers; `preset` and `instruments` name what is not
    drawn; `rods` maps parameters of the plant to `{from: ..., to: ...}`, or to one value for all.

    Raises
    ------
    ConfigurationError
        It is no such file; the message says what in it is wrong.

    """
    values = read_mapping(path, ConfigurationError)
    try:
        return _class(values)
    except KapitsaError as error:
        raise ConfigurationError(f'{path}: {error}') from error


def _class(values: Mapping[str, Any]) -> ClassSettings:
    numbers = [item.name for item in describe(ClassNumbers)]
    keys = (*numbers, 'preset', 'instruments', 'rods')
    if surplus := [str(name) for name in values if name not in keys]:
        raise ConfigurationError(f'no key {", ".join(surplus)}: give some of {", ".join(keys)}')
    rods = values.get('rods', _RODS)
    if not isinstance(rods, dict):
        raise ConfigurationError('rods: give names and values, as in `rods: {length: {from: 0.2, to: 0.3}}`')
    quantities = {item.name: item for item in describe(Plant)}
    if surplus := [str(name) for name in rods if name not in quantities]:
        raise ConfigurationError(f'rods: no parameter {", ".join(surplus)}: give some of {", ".join(quantities)}')
    drawn = {name: _ends(quantities[name], wanted) for name, wanted in rods.items()}
    plant = load_preset(str(values.get('preset', 'ideal')))
    for end in (0, 1):
        plant.replaced({name: ends[end] for name, ends in drawn.items()})  # each alone may be right
    return ClassSettings(
        numbers=ClassNumbers.of({name: values[name] for name in numbers if name in values}),
        plant=plant,
        drawn=drawn,
        instruments=load_instruments(str(values.get('instruments', '1997'))),
    )


def _ends(item: Quantity, wanted: Any) -> tuple[float, float]:
    """Return the ends between which a parameter is drawn."""
    if not isinstance(wanted, dict):
        value = item.check(wanted, ConfigurationError)
        return value, value
    if set(wanted) != {'from', 'to'}:
        raise ConfigurationError(f'{item.name}: an interval is written {{from: 0.2, to: 0.3}}')
    low, high = (item.check(wanted[end], ConfigurationError) for end in ('from', 'to'))
    if not low <= high:
        raise ConfigurationError(f'{item.name}: empty, from {low:g} to {high:g}')
    return low, high
