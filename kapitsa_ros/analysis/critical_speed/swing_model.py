"""What readings a rod should give: periods of swings that narrow while they are timed, and when they stop."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.kernels.slow_period import WORK_ROWS, slow_periods, small_swings
from kapitsa_ros.physics.theory.friction import dithered_factor

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.analysis.evidence import Evidence

    Array = NDArray[np.float64]

_LEAST_DAMPING = 1e-9  # 1/s; below, the limit without any is as good
_MOST_SWINGS = 1e6
_RATIOS, _SPACING = 61, 0.05  # of the table of friction's factor


class SwingModel:
    """Periods and numbers of swings of many rods at once, a row a rod, at the speeds of the evidence.

    A rod is its averaged threshold √(2g/k)/λ, rad/s, its amplitude λ, m, its damping c, 1/s, and its friction f,
    rad/s²: arrays of shape (M,). The small swing's frequency follows from the power series of Mathieu's characteristic
    value (DLMF 28.15.1); the wide one's from the effective potential (see `large_swings`), at the widths it has while
    it is timed: damping takes an equal share of it each period, friction an equal amount (K f/Ω², see `friction`).
    What series and potential leave out is made good by `correction`.
    """

    def __init__(self, evidence: Evidence, gravity: float) -> None:
        self._evidence = evidence
        self._gravity = gravity
        self.correction: Array = np.ones_like(evidence.timed.period)
        """True period over that of this model, shape (N,)."""
        # Columns of a table: kernels want their numbers behind one another.
        self._speed = np.ascontiguousarray(evidence.timed.forcing[None, :])
        self._release, self._swings = np.ascontiguousarray(evidence.release), np.ascontiguousarray(evidence.swings)
        self._stops = np.array([(stop.speed, stop.release, stop.swings) for stop in evidence.stops]).reshape(-1, 3).T

    def k(self, threshold: Array, amplitude: Array) -> Array:
        """Return m·l_c/I, 1/m, of rods."""
        return np.asarray(2.0 * self._gravity / (threshold * amplitude) ** 2)

    def small(self, threshold: Array, amplitude: Array, damping: Array, speed: Array) -> Array:
        """Return Ω of small swings, rad/s, shape (M, N)."""
        k = self.k(threshold, amplitude)
        slow = np.empty((k.size, speed.shape[-1]))
        forcing = np.ascontiguousarray(np.atleast_2d(speed))
        small_swings(k, amplitude, damping, forcing, self._gravity, slow, np.empty((WORK_ROWS, k.size)))
        return slow

    def periods(
        self, threshold: Array, amplitude: Array, damping: Array, coulomb: Array, forcing: Array | None = None
    ) -> tuple[Array, Array]:
        """Return what a stopwatch would show per swing, s, and how far that can be trusted, relative; shapes (M, N).

        The potential softens the swing by a factor 1 + w, good to about w²; friction lengthens a period by the order
        of the squared share of the width that it takes, of which nothing is said here. Speeds are those of the
        evidence, or `forcing`, shape (M, N).
        """
        timed = self._evidence.timed
        period, doubt = np.empty((threshold.size, timed.period.size)), np.empty((threshold.size, timed.period.size))
        slow_periods(
            self.k(threshold, amplitude),
            amplitude,
            damping,
            coulomb,
            self._speed if forcing is None else np.ascontiguousarray(forcing),
            self._release,
            self._swings,
            self._gravity,
            _friction_factors(),
            _SPACING,
            period,
            doubt,
            np.empty((WORK_ROWS, threshold.size)),
        )
        return period * self.correction, doubt

    def swings_before_stop(
        self, threshold: Array, amplitude: Array, damping: Array, coulomb: Array
    ) -> tuple[Array, Array]:
        """Return how many slow periods a swing lasts: of those that were timed, and of those that stopped before."""
        timed = self._evidence.timed.forcing
        speed = np.concatenate((timed, self._stops[0]))
        release = np.concatenate((self._evidence.release, self._stops[1]))
        reach = (self.k(threshold, amplitude) * amplitude)[:, None]
        slow = self.small(threshold, amplitude, damping, speed)
        loss = _loss(slow, reach, coulomb, speed)
        rate = damping[:, None] * np.pi / slow  # of the width, a period
        start = release / (1.0 - np.minimum(reach, 0.9))
        light = np.maximum(rate, _LEAST_DAMPING)
        lasts = np.minimum(np.log1p(start * light / np.maximum(loss, 1e-12)) / light, _MOST_SWINGS)
        return lasts[:, : timed.size], lasts[:, timed.size :]

    @property
    def seen(self) -> Array:
        """Full swings that were seen before each stop."""
        return np.asarray(self._stops[2])


def _loss(slow: Array, reach: Array, coulomb: Array, speed: Array) -> Array:
    """Return what friction takes from the width in a period, rad: K(r) f/Ω² with r = Ω/(kλω)."""
    factors = _friction_factors()
    factor = np.interp(slow / (reach * speed), _SPACING * np.arange(_RATIOS), factors)
    return np.asarray(coulomb[:, None] * factor / slow**2)


@cache
def _friction_factors() -> Array:
    return np.array([dithered_factor(_SPACING * index) if index else 0.0 for index in range(_RATIOS)])
