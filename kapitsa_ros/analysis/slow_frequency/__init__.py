"""The frequency of the slow swing, from the motion or from laps, with its standard error."""

from kapitsa_ros.analysis.slow_frequency.estimate import SlowEstimate, SwingRecord
from kapitsa_ros.analysis.slow_frequency.sinusoid_fit import sinusoid_fit_frequency
from kapitsa_ros.analysis.slow_frequency.softening import softening
from kapitsa_ros.analysis.slow_frequency.spectral_peak import spectral_peak_frequency
from kapitsa_ros.analysis.slow_frequency.stopwatch_period import stopwatch_period
from kapitsa_ros.analysis.slow_frequency.zero_crossings import zero_crossing_frequency

__all__ = [
    'SlowEstimate',
    'SwingRecord',
    'sinusoid_fit_frequency',
    'softening',
    'spectral_peak_frequency',
    'stopwatch_period',
    'zero_crossing_frequency',
]
