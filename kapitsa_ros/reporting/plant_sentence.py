"""A plant in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.schema import describe
from kapitsa_ros.units import INCH

if TYPE_CHECKING:
    from kapitsa_ros.schema import Quantity

_IDEAL = Plant()
_SHOWN = ('length', 'amplitude')


def plant_sentence(plant: Plant) -> str:
    """Return rod and stroke, and whatever else is not as on the ideal rod."""
    length, amplitude = (_length(getattr(plant, name)) for name in _SHOWN)
    unlike = [
        _parameter(item, getattr(plant, item.name))
        for item in describe(Plant)
        if item.name not in _SHOWN and getattr(plant, item.name) != getattr(_IDEAL, item.name)
    ]
    return f'Rod of {length}, stroke ±{amplitude}' + (f'; {", ".join(unlike)}' if unlike else '')


def _length(metres: float) -> str:
    return f'{1e3 * metres:.5g} mm ({metres / INCH:.4g} in)'


def _parameter(item: Quantity, value: float) -> str:
    shown = f'{1e3 * value:.4g} mm' if item.unit == 'm' else f'{value:.4g} {item.unit}'.strip()
    return f'{item.name.replace("_", " ")} {item.symbol} = {shown}'.replace('  ', ' ')
