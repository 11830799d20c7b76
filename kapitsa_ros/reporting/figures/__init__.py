"""The report's figures drawn again, and pictures of results; they need matplotlib, which is an extra."""

from kapitsa_ros.reporting.figures.canvas import FORMATS, house_style, save
from kapitsa_ros.reporting.figures.critical_speeds import critical_speeds, deviations_of_critical_speeds
from kapitsa_ros.reporting.figures.extrapolation import extrapolation
from kapitsa_ros.reporting.figures.history import angle_history, time_history
from kapitsa_ros.reporting.figures.report_figures import FIGURES, report_figures
from kapitsa_ros.reporting.figures.spectrum import power_spectrum
from kapitsa_ros.reporting.figures.stability import stability_boundaries, stability_region
from kapitsa_ros.reporting.figures.sweep import frequency_sweep, slow_frequency

__all__ = [
    'FIGURES',
    'FORMATS',
    'angle_history',
    'critical_speeds',
    'deviations_of_critical_speeds',
    'extrapolation',
    'frequency_sweep',
    'house_style',
    'power_spectrum',
    'report_figures',
    'save',
    'slow_frequency',
    'stability_boundaries',
    'stability_region',
    'time_history',
]
