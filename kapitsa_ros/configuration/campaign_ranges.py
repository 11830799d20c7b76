"""What a campaign varies: a YAML file of factors, and the design by which points are chosen among their values."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from kapitsa_ros.configuration import instrument_sets, presets, protocols
from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.configuration.files import read_mapping
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.schema import describe

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from kapitsa_ros.schema import Quantity

Value: TypeAlias = 'str | float'

NAMED = {'preset': presets.FOLDER, 'instruments': instrument_sets.FOLDER, 'protocol': protocols.FOLDER}
"""Factors whose values are names or paths, and the folder of those that are shipped."""
QUANTITIES: Mapping[str, Quantity] = {
    item.name: item for kind in (Plant, StrobeSettings, StopwatchSettings) for item in describe(kind)
}
"""Factors whose values are numbers, as of the plant or of an instrument."""
DESIGNS = ('grid', 'list', 'latin_hypercube')
MOST_POINTS = 100_000
MOST_EXPERIMENTS = 10_000_000
"""At all points together: weeks of a cluster, and what a memory and a folder of parts hold."""

_KEYS = ('design', 'factors', 'experiments', 'points', 'seed')


@dataclass(frozen=True, kw_only=True)
class Ranges:
    """The points of a campaign."""

    factors: tuple[str, ...]
    points: tuple[tuple[Value, ...], ...]
    """Values of the factors at each; quantities in SI."""
    experiments: int | None = None
    """At each point; None where the file does not say."""

    def values(self, point: int) -> dict[str, Value]:
        """Return the values of a point, by factor."""
        return dict(zip(self.factors, self.points[point], strict=True))


ONE_POINT = Ranges(factors=(), points=((),))
"""Nothing is varied."""


def load_ranges(path: Path) -> Ranges:
    """Read ranges.

    `factors` maps names to lists of values, or to `{from: ..., to: ..., count: ...}`, which are evenly spaced. The
    `design` is `grid` (every combination; where none is given), `list` (the first values of all, the second ones...) or
    `latin_hypercube`: `points` of them, drawn with a `seed`, by `scipy.stats.qmc`; `count` is not needed there.

    Raises
    ------
    ConfigurationError
        It is no such file, a factor is unknown or empty, or there are more than `MOST_POINTS` points.

    """
    values = read_mapping(path, ConfigurationError)
    try:
        return _ranges(values)
    except ConfigurationError as error:
        raise ConfigurationError(f'{path}: {error}') from error


def _ranges(values: Mapping[str, Any]) -> Ranges:
    if surplus := sorted(map(str, set(values) - set(_KEYS))):
        raise ConfigurationError(f'no key {", ".join(surplus)}: give some of {", ".join(_KEYS)}')
    design = values.get('design', DESIGNS[0])
    if design not in DESIGNS:
        raise ConfigurationError(f'design is {design!r}: give one of {", ".join(DESIGNS)}')
    given = values.get('factors')
    if not isinstance(given, dict) or not given:
        raise ConfigurationError('no factors: give names and values, as in `factors: {coulomb: [0, 3]}`')
    drawn = design == 'latin_hypercube'
    factors = {str(name): _factor(str(name), wanted, drawn=drawn) for name, wanted in given.items()}
    if not drawn and {'points', 'seed'} & set(values):
        raise ConfigurationError(f'points and seed are of the design latin_hypercube, not of {design}')
    count = _number_of_points(design, factors, values)
    if count > MOST_POINTS:
        raise ConfigurationError(f'{count} points: at most {MOST_POINTS} can be performed')
    points: Sequence[tuple[Value, ...]]
    if design == 'grid':
        for name, each in factors.items():
            if len(set(each)) < len(each):
                raise ConfigurationError(f'{name}: a value is there twice, and would count twice')
        points = list(product(*factors.values()))
    elif design == 'list':
        points = list(zip(*factors.values(), strict=True))
    else:
        points = _latin_hypercube(factors, count, _whole(values, 'seed', 0, least=0, most=2**63 - 1))
    experiments = _whole(values, 'experiments', 1, most=MOST_EXPERIMENTS) if 'experiments' in values else None
    return Ranges(factors=tuple(factors), points=tuple(points), experiments=experiments)


def _number_of_points(design: str, factors: Mapping[str, tuple[Value, ...]], values: Mapping[str, Any]) -> int:
    sizes = {name: len(each) for name, each in factors.items()}
    if design == 'grid':
        count = 1
        for size in sizes.values():
            count *= size
        return count
    if design == 'list':
        if len(set(sizes.values())) > 1:
            found = ', '.join(f'{size} of {name}' for name, size in sizes.items())
            raise ConfigurationError(f'a list takes as many values of each factor: there are {found}')
        return next(iter(sizes.values()))
    if 'points' not in values:
        raise ConfigurationError('a latin_hypercube takes the number of points, as in `points: 40`')
    return _whole(values, 'points', 1, most=MOST_POINTS)


def _factor(name: str, wanted: Any, *, drawn: bool) -> tuple[Value, ...]:
    """Return the values of a factor; of an interval that is drawn from, its two ends."""
    if name not in NAMED and name not in QUANTITIES:
        raise ConfigurationError(f'no factor {name}: give some of {", ".join((*NAMED, *QUANTITIES))}')
    if isinstance(wanted, dict):
        if name in NAMED:
            raise ConfigurationError(f'{name}: give a list of names')
        return _interval(name, wanted, drawn=drawn)
    given = wanted if isinstance(wanted, list) else [] if wanted is None else [wanted]
    if not given:
        raise ConfigurationError(f'{name}: empty, give a list of values')
    if name in NAMED:
        return tuple(str(value) for value in given)
    return tuple(QUANTITIES[name].check(value, ConfigurationError) for value in given)


def _interval(name: str, wanted: Mapping[str, Any], *, drawn: bool) -> tuple[Value, ...]:
    if not {'from', 'to'} <= set(wanted) <= {'from', 'to', 'count'}:
        raise ConfigurationError(f'{name}: an interval is written {{from: 0, to: 3, count: 4}}')
    low, high = (QUANTITIES[name].check(wanted[end], ConfigurationError) for end in ('from', 'to'))
    if not low < high:
        raise ConfigurationError(f'{name}: empty, from {low:g} to {high:g}')
    if drawn:
        return _Interval((low, high))
    if 'count' not in wanted:
        raise ConfigurationError(f'{name}: give the count of values from {low:g} to {high:g}')
    try:
        count = _whole(wanted, 'count', 2, least=2, most=MOST_POINTS)
    except ConfigurationError as error:
        raise ConfigurationError(f'{name}: {error}') from error
    return tuple(np.linspace(low, high, count).tolist())


class _Interval(tuple[float, float]):
    """The ends of an interval, among all others of a factor's values."""

    __slots__ = ()


def _latin_hypercube(factors: Mapping[str, tuple[Value, ...]], count: int, seed: int) -> list[tuple[Value, ...]]:
    from scipy.stats import qmc  # noqa: PLC0415  # it takes a second

    # SciPy has renamed the argument in 1.15; a generator gives the same points under either name.
    unit = qmc.LatinHypercube(len(factors), seed=np.random.default_rng(seed)).random(count)
    columns = [
        [_at(values, float(share)) for share in column] for values, column in zip(factors.values(), unit.T, strict=True)
    ]
    return list(zip(*columns, strict=True))


def _at(values: tuple[Value, ...], share: float) -> Value:
    if isinstance(values, _Interval):
        low, high = values
        return low + share * (high - low)
    return values[int(share * len(values))]


def _whole(values: Mapping[str, Any], name: str, default: int, *, least: int = 1, most: int) -> int:
    value = values.get(name, default)
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise ConfigurationError(f'{name} is {value!r}: give a whole number from {least} to {most}')
    return value
