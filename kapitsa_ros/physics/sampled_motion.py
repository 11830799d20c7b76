"""Sampled motions: what travels between the rooms in blocks of one communication step."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.errors import MotionError

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class SampledMotion:
    """A motion and its first two derivatives at N + 1 equidistant times, both ends of the block included.

    A block stands on its own: nothing is assumed of its neighbours, so accelerations may jump from one to the next.
    Positions are metres (pivot) or radians (pendulum), time is in seconds.

    Raises
    ------
    MotionError
        Arrays of unequal size or fewer than two samples, values that are not finite, a period that is not positive.

    """

    period: float
    """Seconds from one sample to the next."""
    position: NDArray[np.float64]
    """Shape (N + 1,)."""
    rate: NDArray[np.float64]
    """First derivative, shape (N + 1,)."""
    acceleration: NDArray[np.float64]
    """Second derivative, shape (N + 1,)."""

    def __post_init__(self) -> None:
        if not 0 < self.period < math.inf:
            raise MotionError(f'sample period is {self.period} s: it must be positive')
        shape, arrays = self.position.shape, (self.position, self.rate, self.acceleration)
        if not shape == self.rate.shape == self.acceleration.shape or len(shape) != 1 or shape[0] < 2:
            shapes = sorted({array.shape for array in arrays})
            raise MotionError(f'position, rate and acceleration have shapes {shapes}: one size, two samples or more')
        with np.errstate(over='ignore'):
            squares = sum(np.dot(array, array) for array in arrays)
        # Their sum is finite only where every sample is; that takes a third of the time.
        if not (math.isfinite(squares) or all(np.isfinite(array).all() for array in arrays)):
            raise MotionError('a motion sample is not finite')

    @property
    def duration(self) -> float:
        """Seconds from the first sample to the last."""
        return self.period * (self.position.size - 1)
