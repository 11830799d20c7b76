"""The report's page."""

from __future__ import annotations

import io
import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.analysis.experiment import ideal_rod
from kapitsa_ros.analysis.line_fit import fit_inverse_ols
from kapitsa_ros.analysis.results import budget_values, timing_values
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.reporting.allowances import allowances
from kapitsa_ros.reporting.budget_table import HEADINGS, budget_rows, budget_sentences
from kapitsa_ros.reporting.explanation import error_sentences
from kapitsa_ros.reporting.figures import extrapolation, frequency_sweep, stability_boundaries
from kapitsa_ros.reporting.report.content import AS_BUILT_ON_BEARING, TARGET_PERCENT
from kapitsa_ros.reporting.report.drawings import intervals, recorded_spectrum, recorded_swing
from kapitsa_ros.reporting.report_tables import repairs
from kapitsa_ros.resources import resource_path
from kapitsa_ros.units import INCH, RPM, interval_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kapitsa_ros.reporting.report.content import Content

_WIDTH, _HEIGHT = 4.8, 3.5  # in, of a panel: its letters are as large as the text beside it, on a phone too


def render(content: Content) -> str:
    """Return the page: HTML that asks nothing of any other file or host."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.globals.update(error_sentences=error_sentences)
    environment.filters.update(
        rpm=_rpm, inch=_inch, number=_number, ends=_ends, budget_rows=budget_rows, budget_sentences=budget_sentences
    )
    template = environment.from_string(resource_path('config', 'report', 'report.html').read_text(encoding='utf-8'))
    timings = [timing_values(row) for row in content.timings]
    return template.render(
        content=content,
        timings=timings,
        repairs=repairs({'timings': timings}),
        allowances=allowances(_interval_values(content)),
        budget=None if content.budget is None else budget_values(content.budget),
        budget_headings=HEADINGS,
        report=Plant(),
        trials={trial.name: trial for trial in content.trials},
        as_built_on_bearing=AS_BUILT_ON_BEARING,
        figures=_figures(content),
        rpm_unit=RPM,
        target=TARGET_PERCENT,
    )


def _interval_values(content: Content) -> dict[str, Any]:
    curve = content.curve
    return {
        'play_probability': None if curve is None else curve.play_probability,
        'heavy_damping_probability': None if curve is None else curve.heavy_damping_probability,
        'assumptions': asdict(content.assumptions),
    }


def _figures(content: Content) -> list[Markup]:
    ours = content.timed
    nominal = ideal_rod(content.plant)
    try:
        line = fit_inverse_ols(ours)
    except TableError:
        line = None  # Figure 3 is without it, as Table 3 is
    measured = list(zip(ours.forcing.tolist(), ours.slow.tolist(), strict=True))
    speeds = sorted({row.speed for row in content.timings if row.speed is not None})
    figures = [
        intervals(content.estimates, content.predicted, content.truth),
        stability_boundaries(nominal, speeds, stacked=True),
        extrapolation(ours, content.of_1997, line),
    ]
    moved = [run for run in content.runs if run.has_moved()]
    if moved:
        figures += [recorded_swing(moved[-1]), recorded_spectrum(moved[-1])]
    return [_svg(figure) for figure in (*figures, frequency_sweep(nominal, measured))]


def _svg(figure: Figure) -> Markup:
    """Return the figure's drawing alone, with ids of its own, and no date."""
    title = figure.get_suptitle()
    figure.set_size_inches(_WIDTH, _HEIGHT * len(figure.axes))
    with mpl.rc_context({'svg.hashsalt': title, 'svg.fonttype': 'path'}):
        file = io.StringIO()
        figure.savefig(file, format='svg', metadata={'Date': None, 'Creator': None, 'Format': None, 'Type': None})
    drawing = file.getvalue()
    drawing = drawing[drawing.index('<svg') :].replace('<svg ', f'<svg role="img" aria-label="{title}" ', 1)
    return Markup(drawing)  # noqa: S704 - our own drawing


def _rpm(speed: float | None, digits: int = 1) -> str:
    return 'none' if speed is None or math.isnan(speed) else f'{speed / RPM:.{digits}f}'


def _inch(length: float) -> str:
    return f'{length / INCH:.4g} in'


def _number(value: float | None, digits: int = 3) -> str:
    return '' if value is None else f'{value:.{digits}g}'


def _ends(interval: tuple[float | None, float | None] | None, unit: float = 1.0, digits: int = 4) -> str:
    if interval is None:
        return ''
    return interval_text(interval, lambda end: f'{end / unit:.{digits}g}')
