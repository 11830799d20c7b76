"""What goes into an estimate of the slow frequency, and what comes out."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import AnalysisError

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, kw_only=True)
class SlowEstimate:
    """An estimate and its standard uncertainty."""

    value: float
    """rad/s (of a stopwatch: s)."""
    sigma: float
    """Standard uncertainty, same unit; nan where the record does not tell."""
    decay: float = math.nan
    """γ of an amplitude that goes as e^(−γt), 1/s; nan where it was not fitted."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SwingRecord:
    """The angle of a free swing, and the speed of the shaft that forces it.

    Raises
    ------
    AnalysisError
        Values that are not finite, or a record too short or too coarse to show the forcing.

    """

    angle: NDArray[np.float64]
    """θ, rad, at equidistant times, shape (N,)."""
    period: float
    """Seconds between samples."""
    forcing: float
    """ω, rad/s."""

    def __post_init__(self) -> None:
        if self.angle.ndim != 1 or not np.isfinite(self.angle).all():
            raise AnalysisError('the angle is not a row of finite numbers')
        if not (self.period > 0.0 and 0.0 < self.forcing * self.period < math.pi):
            raise AnalysisError(
                f'samples {self.period} s apart do not resolve a shaft at {self.forcing} rad/s: sample it more often'
            )
        if self.angle.size * self.period * self.forcing < 16.0 * math.pi:
            raise AnalysisError('the record is shorter than eight turns of the shaft: record for longer')

    @property
    def times(self) -> NDArray[np.float64]:
        """Seconds from the first sample, shape (N,)."""
        return np.arange(self.angle.size, dtype=np.float64) * self.period

    def beginning(self, periods: int) -> SwingRecord:
        """Return the part that has about so many slow periods; the whole where it has no more."""
        means = self.drive_nulled()[1]
        found = 1 + int(np.argmax(np.abs(np.fft.rfft(means)[1:])))
        return self if found <= periods else replace(self, angle=self.angle[: self.angle.size * periods // found])

    def drive_nulled(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Average over whole turns of the shaft, which nulls the forcing's lines and thins the record.

        Returns
        -------
        times, means
            Shape (turns,): the middle of each turn (s), and the mean angle over it (rad).

        """
        turn = 2.0 * math.pi / self.forcing
        turns = int(self.angle.size * self.period / turn)
        edges = np.arange(turns + 1, dtype=np.float64) * turn
        area = np.concatenate(((0.0,), np.cumsum(self.angle) * self.period))  # each sample stands for the gap after it
        total = np.interp(edges, np.arange(area.size) * self.period, area)
        return edges[:-1] + 0.5 * (turn - self.period), np.diff(total) / turn
