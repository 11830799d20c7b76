"""The estimate of the report: the highest line of the spectrum."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.slow_frequency.estimate import SlowEstimate

if TYPE_CHECKING:
    from kapitsa_ros.analysis.slow_frequency.estimate import SwingRecord


def spectral_peak_frequency(record: SwingRecord) -> SlowEstimate:
    """Find the highest line below half the forcing frequency (report, Figure 5).

    The error is that of a line that may lie anywhere within its bin: the bin's width over √12.
    """
    spectrum = np.abs(np.fft.rfft(record.angle))
    width = 2.0 * math.pi / (record.angle.size * record.period)
    slow = spectrum[1 : max(2, math.ceil(record.forcing / 2.0 / width))]
    return SlowEstimate(value=(1 + int(np.argmax(slow))) * width, sigma=width / math.sqrt(12.0))
