"""Sampled motions: what travels between the rooms in blocks of one communication step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np

from kapitsa_ros.physics.errors import MotionError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

EVEN = 1e-6  # of a period: how far rounding may move a time


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
        if not (np.isfinite(self.period) and self.period > 0):
            raise MotionError(f'sample period is {self.period} s: it must be positive')
        sizes = {array.shape for array in (self.position, self.rate, self.acceleration)}
        if len(sizes) != 1 or self.position.ndim != 1 or self.position.size < 2:
            raise MotionError(
                f'position, rate and acceleration have shapes {sorted(sizes)}: one size, two samples or more'
            )
        if not all(np.isfinite(array).all() for array in (self.position, self.rate, self.acceleration)):
            raise MotionError('a motion sample is not finite')

    @classmethod
    def at_times(cls, time: ArrayLike, position: ArrayLike, rate: ArrayLike, acceleration: ArrayLike) -> Self:
        """Return a record whose samples carry their times, s.

        Raises
        ------
        MotionError
            Times that run backwards or leave a gap, or what the class itself refuses.

        """
        times = np.asarray(time, dtype=float)
        steps = np.diff(times)
        if times.ndim != 1 or steps.size == 0 or not np.isfinite(times).all():
            raise MotionError('times of a record: give two or more, all finite')
        if steps.min() <= 0:
            at = int(np.argmax(steps <= 0))
            raise MotionError(f'time runs backwards after {times[at]:.9g} s: sort the record')
        period = (times[-1] - times[0]) / steps.size
        uneven = np.abs(times - times[0] - period * np.arange(times.size)) > EVEN * period
        if uneven.any():
            at = int(np.argmax(steps))
            raise MotionError(
                f'{steps[at]:.6g} s follow the sample at {times[at]:.9g} s, others {np.median(steps):.6g} s: '
                'give a record without gaps'
            )
        return cls(float(period), *(np.asarray(array, dtype=float) for array in (position, rate, acceleration)))

    @property
    def duration(self) -> float:
        """Seconds from the first sample to the last."""
        return self.period * (self.position.size - 1)
