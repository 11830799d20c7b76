"""Quantities that answer in the unit in which they were typed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import click

from kapitsa_ros.cli.options import ANGLE, SPEED
from kapitsa_ros.units import RPM, written_unit


@dataclass(frozen=True, kw_only=True)
class Written:
    """A quantity, SI, and the unit it was typed in."""

    value: float
    unit: str
    scale: float
    """How much of the SI unit the typed one is."""

    def text(self, value: float | None = None, digits: int = 6) -> str:
        """Return it, or another quantity of its kind, in the unit it was typed in."""
        return f'{(self.value if value is None else value) / self.scale:.{digits}g} {self.unit}'


class _AsWritten(click.ParamType):  # type: ignore[type-arg]
    """A quantity that remembers its unit."""

    def __init__(self, kind: click.ParamType, unit: str, bare: tuple[str, float]) -> None:  # type: ignore[type-arg]
        self.name = kind.name
        self._kind, self._unit, self._bare = kind, unit, bare

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Written:
        if isinstance(value, Written):
            return value
        number = self._kind.convert(value, param, ctx)
        unit, scale = written_unit(str(value), self._unit) or self._bare
        return Written(value=number, unit=unit, scale=scale)


WRITTEN_SPEED = _AsWritten(SPEED, 'rad/s', ('RPM', RPM))
"""A bare number is RPM."""
WRITTEN_ANGLE = _AsWritten(ANGLE, 'rad', ('rad', 1.0))
"""A bare number is radians."""
