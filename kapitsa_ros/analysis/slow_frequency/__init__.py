"""The frequency of the slow swing, from the motion or from a stopwatch, with its standard uncertainty."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.analysis.slow_frequency.estimate import SlowEstimate, SwingRecord
from kapitsa_ros.analysis.slow_frequency.sinusoid_fit import sinusoid_fit_frequency
from kapitsa_ros.analysis.slow_frequency.softening import softening
from kapitsa_ros.analysis.slow_frequency.spectral_peak import spectral_peak_frequency
from kapitsa_ros.analysis.slow_frequency.stopwatch_period import stopwatch_period
from kapitsa_ros.analysis.slow_frequency.zero_crossings import zero_crossing_frequency

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = [
    'DEFAULT_ESTIMATOR',
    'ESTIMATORS',
    'SlowEstimate',
    'SwingRecord',
    'sinusoid_fit_frequency',
    'softening',
    'spectral_peak_frequency',
    'stopwatch_period',
    'zero_crossing_frequency',
]

ESTIMATORS: dict[str, Callable[[SwingRecord, float], SlowEstimate]] = {
    'sinusoid_fit': sinusoid_fit_frequency,
    'spectral_peak': spectral_peak_frequency,
    'zero_crossings': zero_crossing_frequency,
}
"""By name: from a swing and its softening to the frequency of a small swing."""
DEFAULT_ESTIMATOR = 'sinusoid_fit'
