"""What readings a rod should give: periods of swings that narrow while they are timed, and when they stop."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.theory.friction import dithered_factor

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.analysis.critical_speed.evidence import Evidence

    Array = NDArray[np.float64]

FIRST_PRESS = 0.75
"""Periods from the release to the first press: the second passage through upright."""

_ITERATIONS = 5  # of ν², each of which makes it some 100 times better
_NO_SWING = 1e-10  # ν² that stands for no slow frequency at all
_WIDEST = 1.4  # rad
_BARRIER = 1e-3  # share of the small swing's stiffness that is left to a swing at the barrier
_LEAST_DAMPING = 1e-9  # 1/s; below, the limit without any is as good
_MOST_SWINGS = 1e6
_PHASES = np.sin((np.arange(4) + 0.5) * math.pi / 8.0)  # midpoints: the integrand is periodic and smooth
_NODES, _WEIGHTS = (0.5 * (np.polynomial.legendre.leggauss(2)[0] + 1.0)).tolist(), (0.5, 0.5)  # of the time of a timing


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
        self._stops = np.array([(stop.speed, stop.release, stop.swings) for stop in evidence.stops]).reshape(-1, 3).T

    def k(self, threshold: Array, amplitude: Array) -> Array:
        """Return m·l_c/I, 1/m, of rods."""
        return np.asarray(2.0 * self._gravity / (threshold * amplitude) ** 2)

    def small(self, threshold: Array, amplitude: Array, damping: Array, speed: Array) -> Array:
        """Return Ω of small swings, rad/s, shape (M, N)."""
        k = self.k(threshold, amplitude)
        q2 = ((2.0 * k * amplitude) ** 2)[:, None]
        q4 = q2 * q2 / 32.0
        goal = -4.0 * (k * self._gravity)[:, None] / speed**2 - (damping[:, None] / speed) ** 2
        nu2 = np.clip(goal + 0.5 * q2, 0.0, 0.5)
        for _ in range(_ITERATIONS):
            near, far = nu2 - 1.0, nu2 - 4.0
            nu2 = goal - q2 / (2.0 * near) - (5.0 * nu2 + 7.0) * q4 / (near * near * near * far)
            nu2 = np.clip(nu2, -0.5, 0.5)
        return np.asarray(0.5 * speed * np.sqrt(np.maximum(nu2, _NO_SWING)))

    def periods(
        self, threshold: Array, amplitude: Array, damping: Array, coulomb: Array, forcing: Array | None = None
    ) -> tuple[Array, Array]:
        """Return what a stopwatch would show per swing, s, and how far that can be trusted, relative; shapes (M, N).

        The potential softens the swing by a factor 1 + w, good to about w²; friction lengthens a period by the order
        of the squared share of the width that it takes, of which nothing is said here. Speeds are those of the
        evidence, or `forcing`, shape (M, N).
        """
        timed, release, swings = self._evidence.timed, self._evidence.release, self._evidence.swings
        k = self.k(threshold, amplitude)[:, None]
        reach = k * amplitude[:, None]
        speed = timed.forcing if forcing is None else forcing
        slow = self.small(threshold, amplitude, damping, speed)
        loss = _loss(slow, reach, coulomb, speed)
        start = release / (1.0 - np.minimum(reach, 0.9))  # let go at the bottom of the stroke (report, eq. 12)
        stiffness, weight = 0.5 * (reach * speed) ** 2, k * self._gravity
        linear = np.maximum(stiffness - weight, 1e-6)
        slower = np.zeros_like(slow)
        for node, share in zip(_NODES, _WEIGHTS, strict=True):
            width = _width(start, loss, damping, slow, FIRST_PRESS + node * swings)
            edge = np.sin(0.5 * np.minimum(width, _WIDEST))[..., None]
            half = edge * _PHASES
            left = np.maximum(
                stiffness[..., None] * (1.0 - edge**2 - half**2) - weight[..., None], _BARRIER * linear[..., None]
            )
            slower += share * np.sqrt(linear) * np.mean(1.0 / np.sqrt(left * (1.0 - half**2)), axis=-1)
        middle = np.maximum(_width(start, loss, damping, slow, FIRST_PRESS + 0.5 * swings), loss)
        eaten = np.where(loss > 0.0, loss / np.maximum(middle, 1e-300), 0.0)
        doubt = np.hypot(0.3 * (slower - 1.0) ** 2, 0.1 * eaten**2)
        return 2.0 * math.pi / slow * slower * self.correction, doubt

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
        rate = damping[:, None] * math.pi / slow  # of the width, a period
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
    ratios, factors = _dither_table()
    return np.asarray(coulomb[:, None] * np.interp(slow / (reach * speed), ratios, factors) / slow**2)


@cache
def _dither_table() -> tuple[Array, Array]:
    ratios = np.linspace(0.0, 3.0, 61)
    return ratios, np.array([dithered_factor(ratio) if ratio else 0.0 for ratio in ratios.tolist()])


def _width(start: Array, loss: Array, damping: Array, slow: Array, periods: Array) -> Array:
    """Return the width after some periods, rad: A′ = −cA/2 − (friction's loss), and 0 at the end."""
    decay = damping[:, None] * math.pi / slow * periods
    mean = np.where(decay > 1e-8, -np.expm1(-decay) / np.maximum(decay, 1e-300), 1.0)
    return np.maximum(start * np.exp(-decay) - loss * periods * mean, 0.0)
