"""The report's figures drawn again; they need matplotlib, which is an extra."""

from kapitsa_ros.reporting.figures.history import time_history
from kapitsa_ros.reporting.figures.spectrum import power_spectrum
from kapitsa_ros.reporting.figures.stability import stability_boundaries
from kapitsa_ros.reporting.figures.sweep import frequency_sweep

__all__ = ['frequency_sweep', 'power_spectrum', 'stability_boundaries', 'time_history']
