"""How often the intervals that a class handed in hold the truth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros.analysis.share_range import share_range

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


@dataclass(frozen=True, kw_only=True)
class Coverage:
    """Of the intervals of a class, those handed in last."""

    students: int
    handed_in: int
    judged: int
    """Whose rod has a threshold."""
    covered: int
    share_range: tuple[float, float] | None
    """95 % range of the share that holds, by Clopper and Pearson; None without any."""
    median_width_percent: float | None
    """Of the threshold."""
    median_deviation_percent: float | None
    """Of the critical speeds from the threshold."""


def coverage_of(rows: Sequence[Mapping[str, Any]]) -> Coverage:
    """Sum up what was handed in.

    Parameters
    ----------
    rows
        A bench each, with `name`, `handed_in`, `omega_crit_rpm`, `width_rpm`, `truth_rpm` and `covered`.

    """
    judged = [row for row in rows if row['covered'] is not None]
    covered = sum(row['covered'] for row in judged)
    widths = [100.0 * row['width_rpm'] / row['truth_rpm'] for row in judged]
    deviations = [100.0 * (row['omega_crit_rpm'] / row['truth_rpm'] - 1.0) for row in judged]
    return Coverage(
        students=sum(row['name'] is not None for row in rows),
        handed_in=sum(row['handed_in'] > 0 for row in rows),
        judged=len(judged),
        covered=covered,
        share_range=share_range(covered, len(judged)) if judged else None,
        median_width_percent=float(np.median(widths)) if judged else None,
        median_deviation_percent=float(np.median(deviations)) if judged else None,
    )
