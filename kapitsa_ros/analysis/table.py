"""Readings as the report tables them: forcing speeds and periods of the slow swing, with their errors."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.message import Message

if TYPE_CHECKING:
    from numpy.typing import NDArray

PERIOD_SIGMA = 0.05
"""s; the error of a period where none is given."""

_FEWEST_CYCLES = 5.0  # of the forcing in a slow period: with fewer, no rod is stable at a stroke a saw could have
_LONGEST_PERIOD = 30.0  # s


@dataclass(frozen=True, eq=False)
class Readings:
    """Readings of several runs, shape (N,) each, SI units.

    Raises
    ------
    TableError
        Values no run can have.

    """

    forcing: NDArray[np.float64]
    """ω, rad/s."""
    period: NDArray[np.float64]
    """T of the slow swing, s."""
    forcing_sigma: NDArray[np.float64]
    """Standard uncertainty of ω, rad/s."""
    period_sigma: NDArray[np.float64]
    """Standard uncertainty of T, s."""

    def __post_init__(self) -> None:
        columns = (self.forcing, self.period, self.forcing_sigma, self.period_sigma)
        if len({column.shape for column in columns}) != 1 or self.forcing.ndim != 1:
            raise TableError('the columns are of unequal length: give every row all its values')
        finite = np.logical_and.reduce([np.isfinite(column) for column in columns])
        _refuse(~finite, 'a value is not finite: leave out runs that gave no reading')
        _refuse(self.forcing <= 0.0, 'the speed is zero or negative: leave out runs that gave no reading')
        _refuse(self.period <= 0.0, 'the period is zero or negative: leave out runs that gave no reading')
        _refuse((self.forcing_sigma < 0.0) | (self.period_sigma < 0.0), 'a standard uncertainty is negative')

    @property
    def slow(self) -> NDArray[np.float64]:
        """Ω = 2π/T, rad/s."""
        return 2.0 * math.pi / self.period


def refuse_mixed_units(readings: Readings) -> Readings:
    """Return readings that a person typed, unless they are such that their units must be others.

    Raises
    ------
    TableError
        The shaft turns too few times in a swing, or a period takes too long.

    """
    cycles = readings.forcing * readings.period / (2.0 * math.pi)
    _refuse(
        cycles < _FEWEST_CYCLES,
        'the shaft turns only {value:.2g} times in a swing, which should take many turns: '
        'give the speed in RPM (not Hz or rad/s) and the period in seconds',
        cycles,
    )
    _refuse(
        readings.period > _LONGEST_PERIOD,
        'a period of {value:g} s: give the period in seconds, neither milliseconds nor RPM',
        readings.period,
    )
    _refuse(
        readings.period_sigma > _LONGEST_PERIOD,
        'a standard uncertainty of {value:g} s: give that of a period in seconds',
        readings.period_sigma,
    )
    return readings


def _refuse(wrong: NDArray[np.bool_], message: str, values: NDArray[np.float64] | None = None) -> None:
    """Name the first row that is wrong."""
    if wrong.any():
        row = int(np.argmax(wrong))
        said = Message(message) if values is None else Message(message, value=values[row])
        raise TableError('row {row}: {said}', row=row + 1, said=said)


def require_two_speeds(readings: Readings) -> None:
    """Refuse readings through which no line can be drawn.

    Raises
    ------
    TableError
        Fewer than two rows, or all at one speed.

    """
    if readings.forcing.size < 2:
        raise TableError('too few rows ({count}): time the swing at two speeds or more', count=readings.forcing.size)
    if np.ptp(readings.forcing) <= 1e-9 * readings.forcing.max():
        raise TableError('all speeds are equal: time the swing at another speed too')
