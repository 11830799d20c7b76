"""The reduction of 1997: a line through squared frequencies, both ways round (report, eqs. 15 and 16)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.analysis.table import require_two_speeds

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.analysis.table import Readings
    from kapitsa_ros.physics.plant import Plant


@dataclass(frozen=True, kw_only=True)
class LineFit:
    """Ω² = slope · (ω² − ω_crit²)."""

    omega_crit: float | None
    """rad/s; None where the line meets the axis at no real speed."""
    slope: float
    """Of Ω² over ω², a plain ratio."""


def fit_ols(readings: Readings) -> LineFit:
    """Fit Ω² on ω² by least squares, unweighted (eq. 15).

    Raises
    ------
    TableError
        Fewer than two different speeds, or swings that do not quicken with the speed.

    """
    require_two_speeds(readings)
    slope, intercept = _least_squares(readings.forcing**2, readings.slow**2)
    return _line(slope, -intercept / slope if slope > 0.0 else math.nan)


def fit_inverse_ols(readings: Readings) -> LineFit:
    """Fit ω² on Ω² by least squares, unweighted: the fit of the report's Figure 3 and Table 3 (eq. 16).

    Raises
    ------
    TableError
        Fewer than two different speeds, or swings that do not quicken with the speed.

    """
    require_two_speeds(readings)
    if np.ptp(readings.period) == 0.0:
        raise TableError('all periods are equal, whatever the speed: the runs contradict one another')
    slope, intercept = _least_squares(readings.slow**2, readings.forcing**2)
    return _line(1.0 / slope if slope > 0.0 else -1.0, intercept)


def slope_ratio(line: LineFit, plant: Plant) -> float:
    """Return the slope of a line over that of averaged theory, (kλ)²/2 (eq. 15: 9λ²/8L² for the ideal rod)."""
    return line.slope / (0.5 * (plant.k * plant.amplitude) ** 2)


def _line(slope: float, omega_crit_squared: float) -> LineFit:
    if not slope > 0.0:
        raise TableError('the swing does not quicken with the speed: the runs contradict one another')
    return LineFit(omega_crit=math.sqrt(omega_crit_squared) if omega_crit_squared > 0.0 else None, slope=slope)


def _least_squares(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float]:
    deviation = x - x.mean()
    slope = float(deviation @ (y - y.mean()) / (deviation @ deviation))
    return slope, float(y.mean() - slope * x.mean())
