"""The figures of the report, in their order, with captions."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import AnalysisError, TableError
from kapitsa_ros.analysis.experiment import ideal_rod
from kapitsa_ros.analysis.line_fit import fit_inverse_ols
from kapitsa_ros.analysis.slow_frequency import DEFAULT_ESTIMATOR, ESTIMATORS
from kapitsa_ros.reporting.figures import extrapolation, frequency_sweep, stability_boundaries
from kapitsa_ros.reporting.figures.canvas import BLUE, GREY, INK, ORANGE, blank, write_powers
from kapitsa_ros.reporting.figures.spectrum import amplitudes
from kapitsa_ros.reporting.report.document import drawings_named
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from kapitsa_ros.analysis.recorded_run import FreeSwing, RecordedRun
    from kapitsa_ros.reporting.report.content import Content, Estimate
    from kapitsa_ros.reporting.report.document import Drawing

_SHOWN = 5.0  # s of Figure 4
_ENDS = {'fell': ', the rod falls', 'stopped': ', friction stops it before it is timed'}


def drawings_of(content: Content) -> list[Drawing]:
    """Draw all figures of a report."""
    ours, nominal = content.timed, ideal_rod(content.plant)
    try:
        line = fit_inverse_ols(ours)
    except TableError:
        line = None  # Figure 3 is without it, as Table 3 is
    speeds = sorted({row.speed for row in content.timings if row.speed is not None})
    figures = [
        (
            intervals(content.estimates, content.predicted, content.truth),
            'Each estimate with its interval; an arrow is an end that is unbounded.',
        ),
        (
            stability_boundaries(nominal, speeds, stacked=True),
            'The rod stands in the shaded region; the dots are the speeds of these runs.',
        ),
        (
            extrapolation(ours if ours.period.size else None, content.of_1997, line),
            (
                'Bars are standard uncertainties.'
                if line is None
                else 'The line is extrapolated to Ω = 0, far beyond the readings; bars are standard uncertainties.'
            ),
        ),
    ]
    for run in content.runs:
        if run.has_moved():
            figures += _of_run(run)
    own = None if content.plant == nominal else content.plant
    figures.append(
        (
            frequency_sweep(nominal, list(zip(ours.forcing, ours.slow, strict=True)), readings=ours, own=own),
            (
                'Theory and simulation of the ideal rod, and of the plant simulated where that is another; '
                'bars are standard uncertainties.'
            ),
        )
    )
    return drawings_named(figures)


def _of_run(run: RecordedRun) -> list[tuple[Figure, str]]:
    """Draw every swing of a run, and the spectrum of each after which the rod did not fall."""
    figures = []
    swings = run.swings()
    for number, swing in enumerate(swings, start=1):
        timing = run.timing_of(swing)
        name = run.name if len(swings) == 1 else f'{run.name}, swing {number} of {len(swings)}'
        speed = f'{run.forcing_of(swing) / RPM:.0f} RPM asked for'
        kind = 'timed' if timing is None else timing.kind
        fell = kind == 'fell'
        end = f'let go at {swing.angle[0]:.3g} rad{_ENDS.get(kind, "")}'
        figures.append((recorded_swing(swing, name), f'The angle as recorded, from the release on: {end}, {speed}.'))
        if not fell:
            figures.append(
                (recorded_spectrum(run, swing, name), 'The slow line is Ω, its two companions stand at ω ± Ω.')
            )
    return figures


def recorded_swing(swing: FreeSwing, name: str) -> Figure:
    """Draw Figure 4: the angle as it was recorded, from the release on."""
    figure = blank(f'Figure 4: time history of θ, {name}')
    (axes,) = figure.axes
    shown = swing.time <= _SHOWN
    axes.plot(swing.time[shown], swing.angle[shown], color=BLUE, linewidth=0.7)
    axes.set(xlabel='time since the release (s)', ylabel='θ (rad)')
    return figure


def recorded_spectrum(recorded: RecordedRun, swing: FreeSwing, name: str) -> Figure:
    """Draw Figure 5: the spectrum of a recorded swing."""
    rpm, amplitude = amplitudes(swing.angle, 1.0 / float(np.median(np.diff(swing.time))))
    figure = blank(f'Figure 5: spectrum of θ, {name}')
    (axes,) = figure.axes
    forcing = recorded.forcing_of(swing) / RPM
    shown = rpm <= 1.25 * forcing
    axes.semilogy(rpm[shown], amplitude[shown], color=BLUE, linewidth=0.7)
    write_powers(axes)
    axes.axvline(forcing, color=INK, linewidth=0.6, linestyle=':')
    axes.text(forcing, 0.02, ' ω', transform=axes.get_xaxis_transform(), fontsize=8, color=INK)
    height = float(amplitude.max())
    try:
        slow = ESTIMATORS[DEFAULT_ESTIMATOR](recorded.living_swing(swing), 0.0).value / RPM
    except AnalysisError:
        slow = None  # too short to tell
    if slow is not None:
        axes.annotate(f'Ω = {slow:.1f} RPM', (slow, height), (slow + 0.05 * forcing, height), fontsize=8, color=INK)
    axes.set(xlabel='frequency (RPM)', ylabel='amplitude (rad)', ylim=(None, 3.0 * height))
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
    axes.set_ylim(-0.6, len(estimates) - 0.4)
    axes.legend(fontsize=7, loc='upper center', bbox_to_anchor=(0.4, -0.2), ncols=2)
    return figure
