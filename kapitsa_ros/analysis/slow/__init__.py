"""The frequency of the slow swing, from the motion or from laps, with its standard error."""

from kapitsa_ros.analysis.slow.crossings import crossings_frequency
from kapitsa_ros.analysis.slow.estimate import SlowEstimate, SwingRecord
from kapitsa_ros.analysis.slow.laps import lap_period
from kapitsa_ros.analysis.slow.peak import peak_frequency
from kapitsa_ros.analysis.slow.sinusoid import sinusoid_frequency
from kapitsa_ros.analysis.slow.softening import softening

__all__ = [
    'SlowEstimate',
    'SwingRecord',
    'crossings_frequency',
    'lap_period',
    'peak_frequency',
    'sinusoid_frequency',
    'softening',
]
