"""The figures of the report that come from the runs themselves."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.reporting.figures.canvas import BLUE, GREY, INK, ORANGE, blank
from kapitsa_ros.reporting.figures.spectrum import amplitudes
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from kapitsa_ros.analysis.recorded_run import RecordedRun
    from kapitsa_ros.reporting.report.content import Estimate

_SHOWN = 5.0  # s of Figure 4


def recorded_swing(recorded: RecordedRun) -> Figure:
    """Draw Figure 4: the angle as it was recorded, from the release on."""
    time, angle = recorded.free_swing()
    figure = blank(f'Figure 4: time history of θ, {recorded.name}')
    (axes,) = figure.axes
    shown = time <= _SHOWN
    axes.plot(time[shown], angle[shown], color=BLUE, linewidth=0.7)
    axes.set(xlabel='time since the release (s)', ylabel='θ (rad)')
    return figure


def recorded_spectrum(recorded: RecordedRun) -> Figure:
    """Draw Figure 5: the spectrum of the recorded swing."""
    time, angle = recorded.free_swing()
    rpm, amplitude = amplitudes(angle, 1.0 / float(np.median(np.diff(time))))
    figure = blank(f'Figure 5: spectrum of θ, {recorded.name}')
    (axes,) = figure.axes
    forcing = recorded.run.speed_asked / RPM
    shown = rpm <= 1.25 * forcing
    axes.semilogy(rpm[shown], amplitude[shown], color=BLUE, linewidth=0.7)
    axes.axvline(forcing, color=INK, linewidth=0.6, linestyle=':', label='ω')
    axes.set(xlabel='frequency (RPM)', ylabel='amplitude (rad)')
    axes.legend(fontsize=8)
    return figure


def intervals(estimates: Sequence[Estimate], predicted: float, truth: float | None) -> Figure:
    """Draw the estimates of the critical speed with their intervals; an arrow is an end that is unbounded."""
    figure = blank('Critical speed, 95 % intervals')
    (axes,) = figure.axes
    left, right = 0.75 * predicted / RPM, 1.5 * predicted / RPM
    for row, estimate in enumerate(reversed(estimates)):
        if estimate.interval is not None:
            low, high = estimate.interval
            axes.plot(
                [left if low is None else low / RPM, right if high is None else high / RPM], [row, row], color=BLUE
            )
            if low is None:
                axes.plot(left, row, marker='<', color=BLUE)
            if high is None:
                axes.plot(right, row, marker='>', color=BLUE)
        if estimate.value is not None:
            axes.plot(estimate.value / RPM, row, 'o', color=ORANGE)
        if estimate.of_1997 is not None:
            axes.plot(estimate.of_1997 / RPM, row, 's', color=GREY, markerfacecolor='none')
    axes.axvline(predicted / RPM, color=INK, linestyle='--', linewidth=0.8, label='predicted (eq. 8)')
    if truth is not None:
        axes.axvline(truth / RPM, color=INK, linewidth=0.8, label='exact, of the plant simulated')
    axes.plot([], [], 'o', color=ORANGE, label='these runs')
    axes.plot([], [], 's', color=GREY, markerfacecolor='none', label='readings of 1997')
    axes.set(
        xlabel='ω_crit (RPM)', yticks=range(len(estimates)), yticklabels=[fill(e.name, 12) for e in reversed(estimates)]
    )
    axes.set_xlim(left - 20, right + 20)
    axes.legend(fontsize=7, loc='upper center', bbox_to_anchor=(0.4, -0.2), ncols=2)
    return figure
