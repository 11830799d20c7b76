"""Swings that may have been counted one wrong: which counts all readings together make probable."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.critical_speed.likelihood import FLOOR, Likelihood
from kapitsa_ros.analysis.critical_speed.posterior import HIGHEST, rods_of_prior
from kapitsa_ros.analysis.evidence import by_reading, evidence_of
from kapitsa_ros.physics.theory.averaged import k_of_slow_frequency

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.analysis.ruler import Ruler
    from kapitsa_ros.analysis.timing_row import TimingRow

    Array = NDArray[np.float64]

_WRONG = np.array([0, 1, -1])  # true count less the one that was noted
_RODS, _THRESHOLDS = 64, 128
_COARSE = 0.015  # least relative error of a period, so that no maximum lies between the thresholds tried
_NEAR = 12.0  # of ln L, from the highest
_NEGLIGIBLE = 0.003  # probability
_MOST = 8


@dataclass(frozen=True, kw_only=True, eq=False)
class Counts:
    """Timings with counts that may be the true ones."""

    rows: tuple[TimingRow, ...]
    """With `swings_taken` where a count is another than the one noted."""
    log_weight: float
    """ln of how probable these counts make the displays, over how probable the evidence of these rows is."""


def may_be_miscounted(row: TimingRow) -> bool:
    """Whether swings were counted of which a period was taken."""
    return bool(row.kind == 'timed' and row.unused is None and row.speed and row.swings)


def probable_counts(
    rows: Sequence[TimingRow], ruler: Ruler, gravity: float, assumptions: Assumptions
) -> tuple[Counts, ...]:
    """Find the counts of swings that the readings of one plant leave probable; the first is the likeliest.

    A rod and a threshold give each timing a period, and so a probability that it was counted right, one short or one
    over. Rods are drawn from the prior, at thresholds in even steps. What is best somewhere is a candidate; candidates
    are weighed by the sum over all rods. The weights are rough, meant to leave out what need not be fitted.
    """
    index = [number for number, row in enumerate(rows) if may_be_miscounted(row)]
    as_noted = (_counts(rows, index, np.zeros(len(index), dtype=np.int64), assumptions),)
    if not index or not assumptions.miscount_probability:
        return as_noted
    log_likelihood, of_bounds = _log_likelihoods(rows, index, ruler, gravity, assumptions)
    height = log_likelihood.max(axis=0).sum(axis=0) + of_bounds
    best = log_likelihood[:, :, height > height.max() - _NEAR].argmax(axis=0)
    places = _WRONG.size ** np.arange(len(index))[::-1]
    candidates = np.unique(places @ best)[:, None] // places % _WRONG.size
    each = np.arange(len(index))
    weight = np.array(
        [np.logaddexp.reduce(log_likelihood[candidate, each].sum(axis=0) + of_bounds) for candidate in candidates]
    )
    order = np.argsort(-weight)[:_MOST]
    kept = order[weight[order] - np.logaddexp.reduce(weight) > math.log(_NEGLIGIBLE)]
    return tuple(_counts(rows, index, _WRONG[candidates[number]], assumptions) for number in kept) or as_noted


def _log_likelihoods(
    rows: Sequence[TimingRow], index: Sequence[int], ruler: Ruler, gravity: float, assumptions: Assumptions
) -> tuple[Array, Array]:
    """Return ln L of timings that were counted right, one short and one over, shape (3, N, M), and of falls, (M,)."""
    alone = [replace(row, run=None) for row in rows if row.kind != 'timed' or row.unused is not None]
    evidence = evidence_of([*alone, *(replace(rows[number], run=None) for number in index)])
    timed, swings = evidence.timed, evidence.swings
    likelihood = Likelihood(evidence, gravity)
    true_swings = swings + _WRONG[:, None]
    possible = true_swings > 0.5
    period = timed.period * (swings / np.where(possible, true_swings, np.nan))
    k = k_of_slow_frequency(timed.forcing, 2.0 * math.pi / period, ruler.amplitude, gravity)
    guess = np.sqrt(2.0 * gravity / k) / ruler.amplitude
    top = HIGHEST * float(timed.forcing.min())
    low, high = 0.7 * float(np.nanmin(guess)), min(1.2 * float(np.nanmax(guess)), top)
    rods = rods_of_prior(ruler, assumptions, _RODS)
    threshold = np.tile(np.geomspace(min(low, 0.9 * high), high, _THRESHOLDS), _RODS)
    amplitude, damping, coulomb = (
        np.repeat(each, _THRESHOLDS) for each in (rods.amplitude, rods.damping, rods.coulomb)
    )
    # A row a timing from here on: loops over many rods are faster than many loops over few timings.
    expected, doubt = (each.T.copy() for each in likelihood.model.periods(threshold, amplitude, damping, coulomb))
    reach = likelihood.model.k(threshold, amplitude) * amplitude
    of_speed = timed.forcing * timed.forcing_sigma / (8.0 * math.pi**2)
    steepness = of_speed[:, None] * reach**2 * expected**2  # −d ln T/dω, times the error of the speed
    constant = (timed.period_sigma / timed.period) ** 2 + _COARSE**2
    relative = np.sqrt(constant[:, None] + steepness**2 + doubt**2)
    prior = _log_priors(assumptions)[:, None] - np.log(true_swings, where=possible, out=np.zeros_like(period))
    density = np.nan_to_num(period, nan=np.inf)[:, :, None] / expected  # in place from here on: it is a large array
    density -= 1.0
    density /= relative
    density *= density
    density *= -0.5
    density -= np.log(relative * expected)
    density += prior[:, :, None]
    return density, likelihood.bounds(threshold, amplitude, damping).sum(axis=1)


def _log_priors(assumptions: Assumptions) -> Array:
    wrong = assumptions.miscount_probability
    return np.log(np.maximum([1.0 - wrong, 0.5 * wrong, 0.5 * wrong], 1e-300))


def _counts(
    rows: Sequence[TimingRow], index: Sequence[int], wrong: NDArray[np.int64], assumptions: Assumptions
) -> Counts:
    """Take timings as counted wrong by this much.

    The density of a display is that of the period over the count.
    """
    taken = list(rows)
    log_prior = float(_log_priors(assumptions)[wrong].sum())
    for number, off in zip(index, wrong.tolist(), strict=True):
        row = rows[number]
        swings = row.swings + off
        log_prior -= math.log(swings)
        if off:
            ratio = row.swings / swings
            taken[number] = replace(
                row, period=row.period * ratio, period_sigma=row.period_sigma * ratio, swings_taken=swings
            )
    return Counts(rows=tuple(taken), log_weight=log_prior + _log_agreement(taken))


def _log_agreement(rows: Sequence[TimingRow]) -> float:
    """Return ln of how well timings agree that become one row of evidence, whose mean no longer shows it."""
    total = 0.0
    for together in by_reading(rows):
        period = np.array([row.period for row in together])
        sigma = np.maximum([row.period_sigma for row in together], FLOOR * period)
        weight = sigma**-2
        misfit = (period - weight @ period / weight.sum()) / sigma
        total -= 0.5 * float(misfit @ misfit + np.log(weight.sum()) - np.log(weight).sum())
    return total
