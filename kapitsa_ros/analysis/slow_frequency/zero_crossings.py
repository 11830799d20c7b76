"""Passages through upright, numbered and timed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.slow_frequency.softening import of_small_swing
from kapitsa_ros.units import counted

if TYPE_CHECKING:
    from kapitsa_ros.analysis.slow_frequency.estimate import SlowEstimate, SwingRecord


def zero_crossing_frequency(record: SwingRecord, softening: float = 0.0) -> SlowEstimate:
    """Draw a line through the times of the passages over their numbers; its slope is half a period.

    The passages are those of the drive-nulled motion; the error comes of their scatter about the line, and is nan
    where there are only two.

    Parameters
    ----------
    record
        The free swing, a period of it or more.
    softening
        s of `softening`. With 0 the result is the frequency at the amplitude swung, otherwise that of a small swing.

    Raises
    ------
    AnalysisError
        Fewer than two passages.

    """
    times, angle = record.drive_nulled()
    index = np.flatnonzero(np.signbit(angle[1:]) != np.signbit(angle[:-1]))
    if index.size < 2:
        raise AnalysisError(f'{counted(index.size, "passage")} through upright: record for longer')
    before, after = angle[index], angle[index + 1]
    passages = times[index] + (times[index + 1] - times[index]) * before / (before - after)
    number = np.arange(passages.size) - 0.5 * (passages.size - 1)
    spread = float(number @ number)
    half = float(number @ passages) / spread
    value = math.pi / half
    scatter = passages - passages.mean() - half * number
    variance = float(scatter @ scatter) / (passages.size - 2) / spread if passages.size > 2 else math.nan
    return of_small_swing(record, value, value * math.sqrt(variance) / half, softening)
