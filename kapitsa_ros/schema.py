"""Quantities: what the fields of a parameter set carry, and the one check of their values.

ROS parameters, command-line options, the checks of YAML files, the settings in bags and the tables in README are all
derived from these fields.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from functools import cache
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any, ClassVar, Self

from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.units import is_quantity, magnitude, parse_quantity

if TYPE_CHECKING:
    from collections.abc import Mapping

_KEY = 'quantity'
_ASCII = {'λ': 'lambda', 'κ': 'kappa', 'ρ': 'rho', 'μ': ' mu', 'φ': ' phi', '²': '^2', '·': ' '}


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """One parameter: a number with a unit and a range."""

    name: str
    default: float
    unit: str
    """SI; empty for a plain ratio."""
    low: float
    high: float
    symbol: str
    description: str
    above: bool
    """Whether `low` itself is outside the range."""
    loss: str | None
    """How the motion loses energy by it: `viscous`, `other` or None."""

    @property
    def kind(self) -> type[int | float]:
        """`int` or `float`."""
        return type(self.default)

    @property
    def range(self) -> str:
        """In words, without the unit."""
        low, high = (f'{end:.6g}' if self.kind is float else str(end) for end in (self.low, self.high))
        return f'above {low}, at most {high}' if self.above else f'in [{low}, {high}]'

    def check(self, value: Any, error: type[KapitsaError]) -> Any:
        """Return a value as a plain number in SI, an `int` or a `float` as the default is.

        Parameters
        ----------
        value
            A number, one of numpy's included; a text of a number and perhaps a unit; or a quantity of a library of
            units, which has `.to(unit).magnitude`.
        error
            What is raised.

        Raises
        ------
        KapitsaError
            It is none of these, not finite, of another dimension, or out of the range.

        """
        try:
            number = self._number(value)
            finite = math.isfinite(number)
        except (ValueError, TypeError, AttributeError, OverflowError) as cause:
            raise error(f'{self.name} is {value!r}: {self._wanted}') from cause
        if not finite:
            raise error(f'{self.name} is {value}: {self._wanted}')
        if not self.holds(number):
            given = f'{value} ({self._with_unit(f"{number:.6g}")})' if isinstance(value, str) else number
            must = self.range if self.above else f'lie {self.range}'
            raise error(f'{self.name} is {given}: it must {"be " if self.above else ""}{self._with_unit(must)}')
        return number

    def holds(self, number: Any) -> Any:
        """Tell whether a number lies in the range; of an array, each."""
        return ((self.low < number) if self.above else (self.low <= number)) & (number <= self.high)

    @property
    def _wanted(self) -> str:
        what = 'whole' if self.kind is int else 'finite'
        return f'give a {what} number{f" in {self.unit}" if self.unit else ""}, {self.range}'

    def _with_unit(self, text: str) -> str:
        return f'{text} {self.unit}'.strip()

    def _number(self, value: Any) -> Any:
        if type(value) is self.kind:
            return value
        if is_quantity(value):
            value = magnitude(value, self.unit)
        if getattr(value, 'shape', None) == () and hasattr(value, 'item'):  # numpy's scalars
            value = value.item()
        if isinstance(value, str):
            return int(value) if self.kind is int else parse_quantity(value, self.unit)
        if isinstance(value, bool) or not isinstance(value, Integral if self.kind is int else Real):
            raise TypeError(value)
        plain: Any = value
        return self.kind(plain)


def quantity(  # read as a line of a table
    default: float,
    unit: str,
    low: float,
    high: float,
    *,
    description: str,
    symbol: str = '',
    above: bool = False,
    loss: str | None = None,
) -> Any:
    """Return the field of a parameter set: a dataclass on `ParameterSet`.

    Parameters
    ----------
    default
        A `float`, or an `int` for a whole number.
    unit
        SI; empty for a plain ratio.
    low, high
        The range.
    description
        What it is, without its symbol and unit.
    symbol
        In the equations.
    above
        `low` itself is outside the range.
    loss
        How the motion loses energy by it: `viscous` where the equation of small swings stays linear, else `other`.

    """
    described = Quantity(
        name='',
        default=default,
        unit=unit,
        low=low,
        high=high,
        symbol=symbol,
        description=description,
        above=above,
        loss=loss,
    )
    return field(default=default, metadata={_KEY: described})


def describe(kind: type) -> tuple[Quantity, ...]:
    """Return the quantities of a parameter set, in the order of its fields."""
    return _described(kind)


def description_of(item: Quantity) -> str:
    """Return symbol, meaning and unit of a quantity in ASCII, as `ros2 param describe` shows them."""
    text = f'{f"{item.symbol}: " if item.symbol else ""}{item.description}{f", {item.unit}" if item.unit else ""}'
    return ''.join(_ASCII.get(letter, letter) for letter in text)


@cache
def _described(kind: Any) -> tuple[Quantity, ...]:
    return tuple(replace(item.metadata[_KEY], name=item.name) for item in fields(kind) if _KEY in item.metadata)


class ParameterSet:
    """Base of the dataclasses whose fields are quantities: what they are given is checked, and becomes plain numbers.

    Raises
    ------
    KapitsaError
        A value cannot be used; of the class `error`.

    """

    error: ClassVar[type[KapitsaError]] = KapitsaError

    def __post_init__(self) -> None:
        kind: Any = type(self)
        for item in describe(kind):
            value = getattr(self, item.name)
            if type(value) is not item.kind or not item.holds(value):  # else it is a plain number that can be used
                # The dataclasses are frozen.
                object.__setattr__(self, item.name, item.check(value, self.error))

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Self:
        """Return the set with the given values and the defaults of the others.

        Raises
        ------
        KapitsaError
            A name is none of the set, or a value cannot be used.

        """
        return cls(**_known(cls, values))

    def replaced(self, values: Mapping[str, Any]) -> Self:
        """Return the set with some values replaced.

        Raises
        ------
        KapitsaError
            A name is none of the set, or a value cannot be used.

        """
        return replace(self, **_known(type(self), values))  # type: ignore[type-var]


def _known(kind: type[ParameterSet], values: Mapping[str, Any]) -> Mapping[str, Any]:
    names = [item.name for item in fields(kind)]  # type: ignore[arg-type]
    if unknown := [name for name in values if name not in names]:
        raise kind.error(f'no parameter {", ".join(map(str, unknown))}: give some of {", ".join(names)}')
    return values
