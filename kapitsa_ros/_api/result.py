"""What results have in common: how they say what they are, their data frames and their pictures."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kapitsa_ros import units
from kapitsa_ros.extras import import_of_extra
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from types import ModuleType

    import numpy as np
    from numpy.typing import NDArray

    from kapitsa_ros.physics.plant import Plant


def speed_text(speed: float | None, interval: tuple[float | None, float | None] | None = None) -> str:
    """Return a speed in rad/s and RPM, with the digits that its 95 % interval leaves it where it has one."""
    if speed is None or math.isnan(speed):
        return 'none'
    if interval is None or None in interval:
        return f'{speed:.6g} rad/s ({speed / RPM:.6g} RPM)'
    in_si, in_rpm = (units.decimals_within(interval, unit) for unit in (1.0, RPM))
    return f'{speed:.{in_si}f} rad/s ({speed / RPM:.{in_rpm}f} RPM)'


def speeds_text(speeds: NDArray[np.float64]) -> str:
    """Return what speeds there are: a few in full, of many how many and the ends."""
    values = speeds.ravel()
    if values.size <= 4:
        return ', '.join(speed_text(float(speed)) for speed in values) or 'none'
    ends = ' to '.join(speed_text(float(speed)) for speed in (values.min(), values.max()))
    return f'{values.size} of {ends}'


def interval_text(interval: tuple[float | None, float | None] | None) -> str:
    """Return the ends of an interval of speeds."""
    if interval is None:
        return 'none'
    return units.interval_text(interval, lambda end: speed_text(end, interval))


def plant_text(plant: Plant) -> str:
    """Return the rod and its stroke."""
    return f'rod of {plant.length:.6g} m on a stroke of ±{plant.amplitude:.6g} m'


def describe(kind: str, **lines: object) -> str:
    """Return the text of a result: what it is, then a line a field."""
    width = max(map(len, lines))
    return '\n'.join([kind, *(f'  {name.replace("_", " "):{width}}  {value}' for name, value in lines.items())])


def figures() -> ModuleType:
    """Return the module that draws.

    Raises
    ------
    MissingPackageError
        Matplotlib is not installed.

    """
    draw: ModuleType = import_of_extra('kapitsa_ros.reporting.figures', 'a plot', 'report')
    return draw
