"""The estimate of the report: the highest line of the spectrum."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.slow_frequency.softening import of_small_swing

if TYPE_CHECKING:
    from kapitsa_ros.analysis.slow_frequency.estimate import SlowEstimate, SwingRecord


def spectral_peak_frequency(record: SwingRecord, softening: float = 0.0) -> SlowEstimate:
    """Find the highest line below half the forcing frequency (report, Figure 5).

    The error is that of a line that may lie anywhere within its bin: the bin's width over √12.

    Parameters
    ----------
    record
        The free swing, a period of it or more.
    softening
        s of `softening`. With 0 the result is the frequency at the amplitude swung, otherwise that of a small swing.

    """
    spectrum = np.abs(np.fft.rfft(record.angle))
    width = 2.0 * math.pi / (record.angle.size * record.period)
    slow = spectrum[1 : max(2, math.ceil(record.forcing / 2.0 / width))]
    return of_small_swing(record, (1 + int(np.argmax(slow))) * width, width / math.sqrt(12.0), softening)
