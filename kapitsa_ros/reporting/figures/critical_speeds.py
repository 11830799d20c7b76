"""How the critical speeds of many experiments scatter."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.reporting.figures.canvas import BLUE, INK, blank
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray


def critical_speeds(found: NDArray[np.float64], truth: float) -> Figure:
    """Draw a histogram of critical speeds, with the truth (rad/s)."""
    figure = blank('Critical speeds of many experiments')
    (axes,) = figure.axes
    axes.hist(found / RPM, bins='auto', color=BLUE, alpha=0.6)
    axes.axvline(truth / RPM, color=INK, linewidth=0.8, label='exact, of the plant simulated')
    axes.set(xlabel='ω_crit (RPM)', ylabel='experiments')
    axes.legend(fontsize=8)
    return figure


def deviations_of_critical_speeds(ratio: NDArray[np.float64]) -> Figure:
    """Draw a histogram of critical speeds over the truth of each, for experiments on several plants."""
    figure = blank('Critical speeds of many experiments, over the truth of each')
    (axes,) = figure.axes
    axes.hist(100.0 * (ratio - 1.0), bins='auto', color=BLUE, alpha=0.6)
    axes.axvline(0.0, color=INK, linewidth=0.8)
    axes.set(xlabel='deviation from the exact threshold of the plant simulated (%)', ylabel='experiments')
    return figure
