"""Figure 6: the slow frequency over the forcing frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics import theory
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.reporting.figures.canvas import BLUE, GREY, INK, ORANGE, blank
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from kapitsa_ros.analysis.table import Readings
    from kapitsa_ros.physics.plant import Plant

_MARKED = 50  # speeds; more make a line


def frequency_sweep(
    plant: Plant,
    measured: Sequence[tuple[float, float]],
    release: float = 0.12,
    *,
    readings: Readings | None = None,
    own: Plant | None = None,
) -> Figure:
    """Draw simulation, exact and averaged theory from 1000 to 3000 RPM, with measured pairs (ω, Ω) in rad/s.

    Where `readings` are given, their standard uncertainties are bars; where another plant is, its exact theory is drawn
    too.
    """
    figure = blank('Figure 6: slow frequency over forcing frequency')
    (axes,) = figure.axes
    fine, coarse = np.linspace(1000.0, 3000.0, 800), np.arange(1000.0, 3001.0, 50.0)
    axes.plot(
        fine, _rpm(fine, lambda speed: theory.slow_frequency_exact(plant, speed)), color=BLUE, label='exact theory'
    )
    averaged = _rpm(fine, lambda speed: theory.slow_frequency_averaged(plant, speed))
    axes.plot(fine, averaged, color=GREY, linestyle='--', label='averaged theory (eq. 15)')
    simulated = _rpm(coarse, lambda speed: _simulated(plant, speed, release))
    axes.plot(coarse, simulated, 'x', color=INK, markersize=4, label=f'simulation, {release:g} rad')
    if own is not None:
        curve = _rpm(fine, lambda speed: theory.slow_frequency_exact(own, speed))
        label = 'exact theory of the plant simulated' + (', play aside' if own.clearance else '')
        axes.plot(fine, curve, color=ORANGE, linewidth=1.0, linestyle='-.', label=label)
    points = np.reshape(measured, (-1, 2)) / RPM
    if points.size:
        axes.plot(points[:, 0], points[:, 1], 'o', color=ORANGE, label='measured')
    if readings is not None:
        bars = readings.slow / readings.period * readings.period_sigma / RPM
        axes.errorbar(
            points[:, 0], points[:, 1], yerr=bars, xerr=readings.forcing_sigma / RPM, fmt='none', ecolor=ORANGE
        )
    edge = theory.omega_crit_exact(plant) / RPM
    axes.axvspan(0.0, edge, color=GREY, alpha=0.15, linewidth=0)
    axes.text(edge - 15.0, 20.0, f'falls below\n{edge:.1f} RPM', ha='right', fontsize=8, color=INK)
    axes.set(xlabel='ω (RPM)', ylabel='Ω (RPM)', xlim=(1000, 3000), ylim=(0, 160))
    axes.legend(fontsize=8)
    return figure


def slow_frequency(
    speed: NDArray[np.float64], exact: NDArray[np.float64], averaged: NDArray[np.float64], omega_crit: float
) -> Figure:
    """Draw exact and averaged theory at the given speeds; all in rad/s, nan where there is no value."""
    figure = blank('Slow frequency over forcing frequency')
    (axes,) = figure.axes
    order = np.argsort(speed)
    marker = 'o' if speed.size <= _MARKED else ''
    axes.plot(speed[order] / RPM, exact[order] / RPM, color=BLUE, label='exact theory', marker=marker, markersize=3)
    axes.plot(speed[order] / RPM, averaged[order] / RPM, color=GREY, linestyle='--', label='averaged theory (eq. 15)')
    axes.axvline(omega_crit / RPM, color=INK, linewidth=0.8, label='exact critical speed')
    axes.set(xlabel='ω (RPM)', ylabel='Ω (RPM)')
    axes.legend(fontsize=8)
    return figure


def _rpm(speeds: NDArray[np.float64], slow: Callable[[float], float | None]) -> NDArray[np.float64]:
    values = (slow(speed) for speed in speeds * RPM)
    return np.array([np.nan if value is None else value / RPM for value in values])


def _simulated(plant: Plant, speed: float, release: float) -> float | None:
    try:
        return theory.slow_frequency_nonlinear(plant, speed, release)
    except PhysicsError:  # it falls over
        return None
