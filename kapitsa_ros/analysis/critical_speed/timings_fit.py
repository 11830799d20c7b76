"""The exact curve fitted to timings, whose swings may have been counted wrong."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.assumptions import DEFAULT_ASSUMPTIONS, Assumptions
from kapitsa_ros.analysis.critical_speed.direct_fit import CriticalSpeed, CurveFit
from kapitsa_ros.analysis.critical_speed.miscounts import may_be_miscounted, probable_counts
from kapitsa_ros.analysis.critical_speed.posterior import Posterior, mixture
from kapitsa_ros.analysis.errors import NothingTimedError
from kapitsa_ros.analysis.evidence import Evidence, evidence_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from kapitsa_ros.analysis.critical_speed.miscounts import Counts
    from kapitsa_ros.analysis.ruler import Ruler
    from kapitsa_ros.analysis.timing_row import TimingRow


@dataclass(frozen=True, kw_only=True)
class TimingsFit:
    """What timings say, with the likeliest counts of their swings."""

    rows: tuple[TimingRow, ...]
    """With the counts that were taken: what every estimate rests on."""
    evidence: Evidence
    """Of these rows."""
    best: CriticalSpeed | None
    """None where nothing was timed."""


def fit_timings(
    rows: Sequence[TimingRow], ruler: Ruler, gravity: float, assumptions: Assumptions = DEFAULT_ASSUMPTIONS
) -> TimingsFit:
    """Fit the exact curve to timings as `direct_fit` does, for all counts of their swings that are probable.

    Each set of counts has a fit of its own; they are weighed by their evidence. The estimate is that of the likeliest,
    the interval that of all together. An error beyond those stated is looked for only where the likeliest needs one.
    """
    every = probable_counts(rows, ruler, gravity, assumptions)
    try:
        fits = [CurveFit(evidence_of(counts.rows), ruler, gravity, assumptions) for counts in every]
    except NothingTimedError:
        return TimingsFit(rows=tuple(rows), evidence=evidence_of(rows), best=None)
    posteriors, share = _weighed(every, fits)
    if fits[int(share.argmax())].is_improbable:
        for fit in fits:
            fit.reconcile()
        posteriors, share = _weighed(every, fits)
    likeliest = int(share.argmax())
    return TimingsFit(
        rows=_with_probabilities(every, share, likeliest),
        evidence=fits[likeliest].likelihood.evidence,
        best=fits[likeliest].answer(mixture(posteriors, share)),
    )


def _weighed(every: Sequence[Counts], fits: Sequence[CurveFit]) -> tuple[list[Posterior], NDArray[np.float64]]:
    """Return what is possible with each set of counts, and the probability of each set."""
    posteriors: list[Posterior] = []
    for fit in fits:
        posteriors.append(fit.posterior(posteriors[0] if posteriors else None))
    log_weight = np.array(
        [counts.log_weight + possible.log_evidence for counts, possible in zip(every, posteriors, strict=True)]
    )
    return posteriors, np.exp(log_weight - np.logaddexp.reduce(log_weight))


def _with_probabilities(every: Sequence[Counts], share: NDArray[np.float64], likeliest: int) -> tuple[TimingRow, ...]:
    wrong = np.array([[row.swings_taken is not None for row in counts.rows] for counts in every])
    return tuple(
        replace(row, miscount_probability=float(probability)) if may_be_miscounted(row) else row
        for row, probability in zip(every[likeliest].rows, share @ wrong, strict=True)
    )
