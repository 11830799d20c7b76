"""Figure 3: the line that is extrapolated to the critical speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.reporting.figures.canvas import BLUE, GREY, ORANGE, blank
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kapitsa_ros.analysis.line_fit import LineFit
    from kapitsa_ros.analysis.table import Readings


def extrapolation(ours: Readings, theirs: Readings, line: LineFit | None) -> Figure:
    """Draw Figure 3: readings and the line that was extrapolated, if there is one, in the report's axes."""
    figure = blank('Figure 3: forcing over slow frequency')
    (axes,) = figure.axes
    slow = np.linspace(0.0, 1.1 * np.concatenate((ours.slow, theirs.slow)).max(), 200)
    if line is not None and line.omega_crit is not None:
        forcing = np.sqrt(line.omega_crit**2 + slow**2 / line.slope)
        axes.plot(slow / RPM, forcing / RPM, color=BLUE, label='least squares, as in 1997')
    bars = ours.slow / ours.period * ours.period_sigma / RPM
    axes.errorbar(ours.slow / RPM, ours.forcing / RPM, xerr=bars, fmt='o', color=ORANGE, label='these runs')
    bars = theirs.slow / theirs.period * theirs.period_sigma / RPM
    axes.errorbar(theirs.slow / RPM, theirs.forcing / RPM, xerr=bars, fmt='s', color=GREY, label='1997')
    axes.set(xlabel='Ω (RPM)', ylabel='ω (RPM)', ylim=(0, 3000))
    axes.legend(fontsize=8)
    return figure
