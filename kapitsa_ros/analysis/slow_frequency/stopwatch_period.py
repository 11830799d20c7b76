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


def stopwatch_period(displayed: Sequence[float], swings: int, stopwatch: StopwatchSettings) -> SlowEstimate:
    """Average the timings of `swings` full swings each into one period.

    A display that truncates reads half a digit short on average, a thumb that anticipates presses early at the end:
    both are made good. Each timing errs by two presses and by what the last digit hides.

    Parameters
    ----------
    displayed
        What the stopwatch showed at the end of each timing, s.
    swings
        Full swings a timing.
    stopwatch
        What is known of the stopwatch and of the person.

    Raises
    ------
    AnalysisError
        No timings, or timings of no length.

    """
    shown = np.asarray(displayed, dtype=np.float64)
    if not shown.size or swings < 1 or not (shown > 0.0).all():
        raise AnalysisError('no period: give one timing or more, each longer than zero')
    digit = stopwatch.display_resolution
    early = stopwatch.anticipation * stopwatch.reaction_time
    variance = 2.0 * stopwatch.reaction_jitter**2 + digit**2 / 12.0
    mean = float(shown.mean()) + 0.5 * digit + early
    return SlowEstimate(value=mean / swings, sigma=math.sqrt(variance / shown.size) / swings)
