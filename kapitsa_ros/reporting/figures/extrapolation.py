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


def extrapolation(ours: Readings | None, theirs: Readings, line: LineFit | None) -> Figure:
    """Draw Figure 3: readings and the line that was extrapolated, if there is one, in the report's axes.

    Without readings of one's own it is that of 1997.
    """
    figure = blank('Figure 3: forcing over slow frequency')
    (axes,) = figure.axes
    drawn = [(theirs, 's', GREY, '1997')]
    if ours is not None:
        drawn.insert(0, (ours, 'o', ORANGE, 'these runs'))
    slow = np.linspace(0.0, 1.1 * np.concatenate([readings.slow for readings, *_ in drawn]).max(), 200)
    if line is not None and line.omega_crit is not None:
        forcing = np.sqrt(line.omega_crit**2 + slow**2 / line.slope)
        axes.plot(slow / RPM, forcing / RPM, color=BLUE, label='least squares, as in 1997')
    for readings, marker, colour, label in drawn:
        bars = readings.slow / readings.period * readings.period_sigma / RPM
        axes.errorbar(readings.slow / RPM, readings.forcing / RPM, xerr=bars, fmt=marker, color=colour, label=label)
    axes.set(xlabel='Ω (RPM)', ylabel='ω (RPM)', xlim=(0, None), ylim=(0, 3000))
    axes.legend(fontsize=8)
    return figure
