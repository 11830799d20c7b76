"""Figure 2: where the upright rod is stable."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import ListedColormap

from kapitsa_ros.physics import theory
from kapitsa_ros.reporting.figures.canvas import BLUE, GREY, INK, ORANGE, blank
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from kapitsa_ros.physics.plant import Plant


def stability_boundaries(plant: Plant, speeds: Sequence[float], *, stacked: bool = False) -> Figure:
    """Draw Mathieu's chart and the same in speed and amplitude, with the rig's operating points (rad/s) on both."""
    figure = blank('Figure 2: stability of the upright rod', panels=2, stacked=stacked)
    chart, bench = figure.axes
    _draw_chart(chart, plant, speeds)
    _draw_bench(bench, plant, speeds)
    return figure


def _draw_chart(axes: Axes, plant: Plant, speeds: Sequence[float]) -> None:
    q = np.linspace(0.0, 1.0, 200)
    lower = [theory.characteristic_a0(one) for one in q]
    upper = [theory.characteristic_b1(one) for one in q]
    axes.fill_between(q, lower, upper, color=BLUE, alpha=0.15, label='stable')
    axes.plot(q, lower, color=BLUE, label='a₀(q), exact')
    axes.plot(q, upper, color=BLUE, linestyle='-.', label='b₁(q), exact')
    axes.plot(
        q, [theory.boundary_perturbed(one) for one in q.tolist()], color=GREY, linestyle='--', label='a = −q²/2 (eq. 7)'
    )
    points = [theory.mathieu_a(plant, speed) for speed in speeds]
    axes.plot([theory.mathieu_q(plant)] * len(points), points, 'o', color=ORANGE, markersize=4, label='the runs')
    axes.axhline(0.0, color=INK, linewidth=0.6)
    axes.set(xlabel='q = 2kλ (3λ/L)', ylabel='a = −4kg/ω² (−6g/ω²L)', xlim=(0, 1), ylim=(-0.5, 0.6))
    axes.legend(fontsize=8, loc='upper right')


def _draw_bench(axes: Axes, plant: Plant, speeds: Sequence[float]) -> None:
    rpm = np.linspace(500.0, 4000.0, 700)
    ratio = np.linspace(0.005, 0.4, 600)
    found = theory.stability_map(plant, rpm * RPM, ratio * plant.length)
    axes.contourf(rpm, ratio, found.stable, levels=[0.5, 1.5], colors=[BLUE], alpha=0.15)
    axes.contour(rpm, ratio, found.stable, levels=[0.5], colors=[BLUE], linewidths=1.2)
    axes.plot([], [], color=BLUE, label='exact, both limits')
    axes.fill_between([], [], color=BLUE, alpha=0.15, label='stable')
    averaged = np.sqrt(2.0 * plant.gravity / plant.k) / (rpm * RPM) / plant.length
    axes.plot(rpm, averaged, color=GREY, linestyle='--', label='averaged (eq. 8)')
    points = np.asarray(speeds) / RPM
    axes.plot(
        points, np.full(points.size, plant.amplitude / plant.length), 'o', color=ORANGE, markersize=4, label='the runs'
    )
    axes.set(xlabel='ω (RPM)', ylabel='λ/L', xlim=(500, 4000), ylim=(0, 0.4))
    axes.legend(fontsize=8, loc='center right')


def stability_region(speed: NDArray[np.float64], amplitude: NDArray[np.float64], stable: NDArray[np.bool_]) -> Figure:
    """Draw where the upright rod is stable, over speeds (rad/s) and amplitudes (m)."""
    figure = blank('Stability of the upright rod')
    (axes,) = figure.axes
    axes.pcolormesh(speed / RPM, amplitude, stable, cmap=ListedColormap(['white', BLUE]), alpha=0.4, vmin=0, vmax=1)
    axes.set(xlabel='ω (RPM)', ylabel='λ (m)')
    return figure
