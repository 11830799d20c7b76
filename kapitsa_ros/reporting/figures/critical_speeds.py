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
