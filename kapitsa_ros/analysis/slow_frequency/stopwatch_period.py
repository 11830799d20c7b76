"""The period from what a stopwatch displayed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.slow_frequency.estimate import SlowEstimate

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings


def stopwatch_period(displayed: Sequence[float], swings: Sequence[int], stopwatch: StopwatchSettings) -> SlowEstimate:
    """Fit one period to timings of some full swings each, by least squares.

    A display that truncates reads half a digit short on average, a thumb that anticipates presses early at the end:
    both are made good. Each timing errs by two presses and by what the last digit hides.

    Parameters
    ----------
    displayed
        What the stopwatch showed at the end of each timing, s.
    swings
        Full swings of each timing.
    stopwatch
        What is known of the stopwatch and of the person.

    Raises
    ------
    AnalysisError
        No timings, or timings of no length.

    """
    shown, counted = np.asarray(displayed, dtype=np.float64), np.asarray(swings, dtype=np.float64)
    if not shown.size or shown.shape != counted.shape or not ((counted >= 1.0) & (shown > 0.0)).all():
        raise AnalysisError('no period: give one timing or more, each longer than zero')
    digit = stopwatch.display_resolution
    early = stopwatch.anticipation * stopwatch.reaction_time
    variance = 2.0 * stopwatch.reaction_jitter**2 + digit**2 / 12.0
    weight = counted / counted.mean()
    mean = float((weight * shown).mean()) + 0.5 * digit + early
    return SlowEstimate(
        value=mean / float((weight * counted).mean()),
        sigma=math.sqrt(variance / shown.size) / math.sqrt(float((counted**2).mean())),
    )
