"""What the fields of a parameter set carry, and how values are checked."""

from __future__ import annotations

import math
from dataclasses import field, fields
from typing import Any

from kapitsa_ros.instruments.errors import SettingsError


def quantity(default: float, low: float, high: float, description: str) -> Any:
    return field(default=default, metadata={'low': low, 'high': high, 'description': description})


class Checked:
    """A dataclass of quantities that lie within the ranges of their metadata."""

    def __post_init__(self) -> None:
        for quantity in fields(self):  # type: ignore[arg-type]
            value = getattr(self, quantity.name)
            low, high = quantity.metadata['low'], quantity.metadata['high']
            if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
                raise SettingsError(f'{quantity.name} is {value!r}: give a finite number')
            if not low <= value <= high:
                raise SettingsError(f'{quantity.name} is {value}: it must lie in [{low}, {high}]')
