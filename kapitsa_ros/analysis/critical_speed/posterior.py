"""What the evidence leaves open of the critical speed, whatever play, damping and friction there may be.

Each rod of a sample stands for one possibility of amplitude, play, damping and friction; for each, the threshold that
fits best and its error are found, and the possibilities are weighed by how well they fit (importance sampling; the
proposal adapts itself, see Cappé et al., J. Comput. Graph. Stat. 13, 907 (2004)). The sample is a fixed sequence of
low discrepancy: the same readings give the same interval. Sums over rods are numpy's: those of BLAS hang on the number
of its threads, and on the processor.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import gammaincinv, gammaln, ndtr, ndtri

from kapitsa_ros.physics.theory.play import play_amplitude_ratio

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.analysis.critical_speed.likelihood import Likelihood
    from kapitsa_ros.analysis.ruler import Ruler

    Array = NDArray[np.float64]

_RODS = 512
_DIMENSIONS = 5  # the ruler's error, play, damping, friction, the dial's error: standard normal each
_TAILS = 4.0  # degrees of freedom of the proposal
_ENOUGH, _WORTH = 100.0, 60.0  # rods that count: in the end, and for the next proposal
_ROUNDS = 12  # of one number of rods, then of twice as many each; most readings take fewer than six
_MOST_RODS = 16384
_STEPS = 4  # of Gauss and Newton, to the best threshold of each rod
_AROUND = 16  # thresholds that are tried for each rod
_NEVER = 1e-300  # a probability
_WIDER = 1.2  # so that skewed likelihoods are reached too
HIGHEST = 0.9995
"""Threshold that is tried, over the lowest speed at which a swing was timed."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Rods:
    """Rods that may be, arrays of shape (M,)."""

    amplitude: Array
    """λ of a rod without play, and with a perfect stopwatch and dial, that swings alike, m."""
    damping: Array
    """1/s."""
    coulomb: Array
    """rad/s²."""
    play: Array
    """m."""
    dial: Array
    """Relative error of the dial."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Posterior:
    """A weighted sample of what is possible."""

    threshold: Array
    """Exact critical speed, rad/s, shape (S,), ascending."""
    weight: Array
    """Of each, shape (S,); they add up to 1."""
    effective: float
    """How many of the rods count (Kish)."""
    play_probability: float
    """That the pivot has play."""
    heavy_damping_probability: float
    """That damping is not light."""
    rods: Rods
    """The sample, and"""
    rod_weight: Array
    """the weight of each, shape (M,); they add up to 1."""
    log_evidence: float
    """ln of the probability of the evidence, up to a constant of the number of timings."""
    proposal: tuple[Array, Array | None]
    """Mean and root of what rods were drawn from, or should be next where too few count; without a root, the prior."""

    @property
    def coulomb(self) -> float:
        """Mean of f, rad/s²."""
        return self.mean(self.rods.coulomb)

    def mean(self, values: Array) -> float:
        """Return the mean of values of the rods, shape (M,)."""
        return float(np.sum(self.rod_weight * values))

    def quantile(self, share: float) -> float:
        """Return the critical speed, rad/s, below which a share of the probability lies."""
        middle = np.cumsum(self.weight) - 0.5 * self.weight
        return float(np.interp(share, middle, self.threshold))


def posterior(
    likelihood: Likelihood, ruler: Ruler, assumptions: Assumptions, start: float, like: Posterior | None = None
) -> Posterior:
    """Weigh what is possible.

    Parameters
    ----------
    likelihood
        Of rods.
    ruler
        What is known of λ.
    assumptions
        What is known of all else.
    start
        A threshold that fits about, rad/s.
    like
        Another posterior that this one is much like: what it drew from is the first proposal.

    """
    prior = _Prior(ruler, assumptions)
    mean, root = (np.zeros(_DIMENSIONS), None) if like is None else like.proposal
    for number in _numbers():
        base, chi, offsets = _sequence(number)
        z = prior.place(base) if root is None else mean + np.einsum('mk,jk->mj', base * chi[:, None], root)
        rods = prior.rods(z)
        threshold, log_likelihood = _conditional(likelihood, rods, start, offsets)
        log_weight = log_likelihood
        if root is not None:  # else they were drawn from the prior
            log_weight = log_likelihood + (prior.log_density(z) - _log_student(z, mean, root))[:, None]
        of_rod = np.logaddexp.reduce(log_weight, axis=1)
        if _effective(of_rod) >= _ENOUGH:
            break
        tempered = of_rod
        while _effective(tempered) < _WORTH:
            tempered = 0.7 * tempered
        share = np.exp(tempered - np.logaddexp.reduce(tempered))
        mean = np.sum(share[:, None] * z, axis=0)
        spread = 1.3 * np.einsum('mj,mk->jk', (z - mean) * share[:, None], z - mean)
        root = np.asarray(np.linalg.cholesky(spread + 1e-12 * np.eye(_DIMENSIONS)), dtype=np.float64)
    total = float(np.logaddexp.reduce(of_rod))
    weight = np.exp(log_weight - total)
    each = weight.sum(axis=1)
    exact = likelihood.exact_threshold(
        threshold.ravel(), np.repeat(rods.amplitude, _AROUND), np.repeat(rods.damping, _AROUND)
    ) / np.repeat(1.0 + rods.dial, _AROUND)
    order = np.argsort(exact)
    return Posterior(
        threshold=exact[order],
        weight=weight.ravel()[order],
        effective=_effective(of_rod),
        play_probability=float(np.sum(each[rods.play > 0.0])),
        heavy_damping_probability=float(np.sum(each[rods.damping > 3.0 * assumptions.light_damping])),
        rods=rods,
        rod_weight=each,
        log_evidence=total - math.log(weight.size),
        proposal=(mean, root),
    )


def mixture(posteriors: Sequence[Posterior], share: Array) -> Posterior:
    """Return what is possible where one of several holds, with a probability each, shape (number,)."""
    threshold = np.concatenate([each.threshold for each in posteriors])
    weight = np.concatenate([part * each.weight for part, each in zip(share, posteriors, strict=True)])
    order = np.argsort(threshold)
    likeliest = posteriors[int(share.argmax())]
    return Posterior(
        threshold=threshold[order],
        weight=weight[order],
        effective=1.0 / float(share**2 @ [1.0 / each.effective for each in posteriors]),
        play_probability=float(share @ [each.play_probability for each in posteriors]),
        heavy_damping_probability=float(share @ [each.heavy_damping_probability for each in posteriors]),
        rods=likeliest.rods,
        rod_weight=likeliest.rod_weight,
        log_evidence=likeliest.log_evidence,
        proposal=likeliest.proposal,
    )


def rods_of_prior(ruler: Ruler, assumptions: Assumptions, number: int) -> Rods:
    """Return rods as they are distributed before anything is timed."""
    prior = _Prior(ruler, assumptions)
    return prior.rods(prior.place(_sequence(number)[0]))


def _numbers() -> Iterator[int]:
    """Give the number of rods in each round.

    Where rounds of so many do not find enough that count, more of them say nothing new: the last would do as well as
    any other, and which it is like hangs on the last digits of the readings.
    """
    yield from [_RODS] * _ROUNDS
    number = _RODS
    while number < _MOST_RODS:
        number *= 2
        yield number


@cache
def _sequence(rods: int) -> tuple[Array, Array, Array]:
    """Return standard normal numbers, shape (rods, dimensions), the lengths that make them Student's, and offsets.

    The points are Kronecker's sequence of the powers of the root of x⁸ = x + 1, which fill the unit cube evenly. The
    offsets of each rod, shape (rods, around), are the normal distribution's quantiles at even distances.
    """
    root = 1.0
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (_DIMENSIONS + 3))
    powers = root ** -np.arange(1.0, _DIMENSIONS + 3)
    uniform = (0.5 + np.arange(1.0, rods + 1)[:, None] * powers) % 1.0
    uniform = np.clip(uniform, 1e-9, 1.0 - 1e-9)
    chi_squared = 2.0 * gammaincinv(0.5 * _TAILS, uniform[:, -2])
    offsets = ndtri((np.arange(_AROUND) + uniform[:, -1:]) / _AROUND)
    return np.asarray(ndtri(uniform[:, :-2])), np.sqrt(_TAILS / chi_squared), np.asarray(offsets)


class _Prior:
    """How rods are distributed before anything is timed.

    A rod's coordinates are its amplitude as its swings show it, in standard uncertainties from the ruler's word, and
    four standard normal numbers that stand for play, damping, friction and the dial's error. A stopwatch that runs fast
    by r makes all frequencies seem slower, as an amplitude that is smaller by r would at the same threshold; a dial
    that reads d too much, as an amplitude smaller by d, and a threshold larger by d.
    """

    def __init__(self, ruler: Ruler, assumptions: Assumptions) -> None:
        self._assumptions = assumptions
        self._amplitude = ruler.amplitude
        self._sigma = math.hypot(ruler.sigma, ruler.amplitude * assumptions.stopwatch_rate_u)

    def place(self, normal: Array) -> Array:
        """Return the coordinates of rods that standard normal numbers draw, the first of which is the ruler's error."""
        play, dial = self._play(normal), self._dial(normal)
        ruled = np.maximum(self._amplitude + self._sigma * normal[:, 0], 0.05 * self._amplitude)
        z = normal.copy()
        z[:, 0] = (ruled * play_amplitude_ratio(play / ruled) / (1.0 + dial) - self._amplitude) / self._sigma
        return z

    def rods(self, z: Array) -> Rods:
        """Return the rods of coordinates."""
        assumed = self._assumptions
        is_heavy, share = _alternative(z[:, 2], assumed.heavy_damping_probability)
        light = assumed.light_damping * ndtri(0.5 + 0.5 * np.minimum(share, 1.0 - 1e-9))
        sticks, of_friction = _alternative(z[:, 3], assumed.coulomb_probability)
        friction = assumed.coulomb_scale * np.tan(0.5 * math.pi * np.minimum(of_friction, 1.0 - 1e-6))
        return Rods(
            amplitude=np.maximum(self._amplitude + self._sigma * z[:, 0], 0.05 * self._amplitude),
            damping=np.where(is_heavy, assumed.heavy_damping_limit * share, light),
            coulomb=np.where(sticks, friction, 0.0),
            play=self._play(z),
            dial=self._dial(z),
        )

    def log_density(self, z: Array) -> Array:
        """Return that of the coordinates, up to a constant, shape (M,)."""
        shown = np.maximum(self._amplitude + self._sigma * z[:, 0], 0.05 * self._amplitude)
        play, with_dial = self._play(z), shown * (1.0 + self._dial(z))
        ruled = with_dial
        for _ in range(4):
            ruled = with_dial / play_amplitude_ratio(play / ruled)
        error = (ruled - self._amplitude) / self._sigma
        return np.asarray(-0.5 * error**2 - 0.5 * np.sum(z[:, 1:] ** 2, axis=1))

    def _play(self, z: Array) -> Array:
        has_play, share = _alternative(z[:, 1], self._assumptions.play_probability)
        return np.where(has_play, self._assumptions.play_limit * share, 0.0)

    def _dial(self, z: Array) -> Array:
        return np.maximum(self._assumptions.dial_u * z[:, 4], -0.9)


def _alternative(z: Array, probability: float) -> tuple[NDArray[np.bool_], Array]:
    """Decide for the second of two alternatives with a probability, and return a uniform number for either."""
    level = ndtr(z)
    second = level > 1.0 - probability
    of_second, of_first = max(probability, _NEVER), max(1.0 - probability, _NEVER)
    share = np.where(second, (level - 1.0 + probability) / of_second, level / of_first)
    return second, np.clip(share, 0.0, 1.0)


def _conditional(likelihood: Likelihood, rods: Rods, start: float, offsets: Array) -> tuple[Array, Array]:
    """Return thresholds that are possible for each rod, and ln L there times their spacing, shape (M, offsets)."""
    model, timed = likelihood.model, likelihood.evidence.timed
    others = (rods.amplitude, rods.damping, rods.coulomb)
    top = HIGHEST * float(timed.forcing.min())
    best = np.full(rods.amplitude.size, min(start, 0.99 * top))
    for _ in range(_STEPS):
        step = 1e-4 * best
        period, doubt = model.periods(best, *others)
        slope = (model.periods(best + step, *others)[0] - period) / step[:, None]
        sigma = likelihood.sigma(best, rods.amplitude, doubt)
        information = np.sum((slope / sigma) ** 2, axis=1)
        move = np.sum((timed.period - period) * slope / sigma**2, axis=1) / np.maximum(information, 1e-300)
        best = np.clip(best + np.clip(move, -0.1 * best, 0.1 * best), 0.1 * top, top)
    error = 1.0 / np.sqrt(np.maximum(information, 1e-300))
    error = np.minimum(error, top)
    step = np.minimum(np.minimum(error, 0.03 * best), np.maximum(0.9999 * timed.forcing.min() - best, 1e-6 * best))
    period, doubt = model.periods(best, *others)
    above, below = model.periods(best + step, *others)[0], model.periods(best - step, *others)[0]
    slope = (above - below) / (2.0 * step[:, None])
    bend = (above - 2.0 * period + below) / (2.0 * step[:, None] ** 2)
    threshold = np.maximum(best[:, None] + _WIDER * error[:, None] * offsets, 1e-3 * top)
    away = threshold - best[:, None]
    sigma = likelihood.sigma(best, rods.amplitude, doubt)
    # Divided by sigma, a parabola in the threshold for each rod and timing; their squares add up to one of degree 4.
    constant, linear, square = (timed.period - period) / sigma, -slope / sigma, -bend / sigma
    coefficients = (
        np.sum(square * square, axis=1),
        2.0 * np.sum(square * linear, axis=1),
        np.sum(linear * linear + 2.0 * square * constant, axis=1),
        2.0 * np.sum(linear * constant, axis=1),
        np.sum(constant * constant, axis=1),
    )
    misfit = np.zeros_like(away)
    for coefficient in coefficients:
        misfit = misfit * away + coefficient[:, None]
    log_likelihood = -0.5 * misfit + 0.5 * offsets**2 + np.log(error)[:, None]
    log_likelihood -= np.sum(np.log(sigma), axis=1)[:, None]
    log_likelihood += likelihood.stops(best, *others)[:, None]
    if likelihood.evidence.fell or likelihood.evidence.stood:
        each = (threshold.ravel(), np.repeat(rods.amplitude, _AROUND), np.repeat(rods.damping, _AROUND))
        log_likelihood += likelihood.bounds(*each).sum(axis=1).reshape(threshold.shape)
    return threshold, log_likelihood


def _effective(log_weight: Array) -> float:
    """Return how many of weighted rods count (Kish)."""
    return float(np.exp(2.0 * np.logaddexp.reduce(log_weight) - np.logaddexp.reduce(2.0 * log_weight)))


def _log_student(z: Array, mean: Array, root: Array) -> Array:
    """Return the logarithm of the density of Student's distribution about a mean, with a Cholesky root."""
    away = (z - mean).T
    solved = np.empty_like(away)
    for row, factors in enumerate(root):
        solved[row] = (away[row] - np.sum(factors[:row, None] * solved[:row], axis=0)) / factors[row]
    distance = np.sum(solved**2, axis=0)
    half = 0.5 * (_TAILS + _DIMENSIONS)
    norm = gammaln(half) - gammaln(0.5 * _TAILS) - 0.5 * _DIMENSIONS * math.log(0.5 * _TAILS)
    return np.asarray(norm - np.log(np.diag(root)).sum() - half * np.log1p(distance / _TAILS))
