"""Figures 2 to 6 of the report, for a rod and its readings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.analysis.line_fit import fit_inverse_ols
from kapitsa_ros.reporting.figures.canvas import house_style
from kapitsa_ros.reporting.figures.extrapolation import extrapolation
from kapitsa_ros.reporting.figures.history import time_history
from kapitsa_ros.reporting.figures.spectrum import power_spectrum
from kapitsa_ros.reporting.figures.stability import stability_boundaries
from kapitsa_ros.reporting.figures.sweep import frequency_sweep

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kapitsa_ros.analysis.table import Readings
    from kapitsa_ros.physics.plant import Plant

FIGURES = (2, 3, 4, 5, 6)
"""Their numbers in the report."""


def report_figures(plant: Plant, speed: float, measured: Readings) -> dict[int, Figure]:
    """Draw the figures of the report by their numbers; Figures 4 and 5 at a speed (rad/s)."""
    try:
        line = fit_inverse_ols(measured)
    except TableError:
        line = None
    with house_style():
        drawn = (
            stability_boundaries(plant, measured.forcing.tolist()),
            extrapolation(None, measured, line),
            time_history(plant, speed),
            power_spectrum(plant, speed),
            frequency_sweep(plant, list(zip(measured.forcing, measured.slow, strict=True)), readings=measured),
        )
    return dict(zip(FIGURES, drawn, strict=True))
