"""The report on a class: what was handed in, against the rods as they are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jinja2 import Environment, StrictUndefined

from kapitsa_ros import __version__
from kapitsa_ros.analysis.class_coverage import coverage_of
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.reporting.figures.canvas import blank, house_style
from kapitsa_ros.reporting.report.document import Document, drawings_named
from kapitsa_ros.reporting.report.text import plain
from kapitsa_ros.resources import resource_path
from kapitsa_ros.schema import describe

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure

_HOLDS, _MISSES, _INK = '#1d5c9e', '#c2410c', '#1b1d21'
_TITLE = 'A class before the pendulum'


def class_document(rows: Sequence[Mapping[str, Any]]) -> Document:
    """Return the report.

    Parameters
    ----------
    rows
        A bench each, as the table of the class has them: SI, speeds in RPM.

    """
    judged = [row for row in rows if row['covered'] is not None]
    with house_style():
        figures = [(_figure(judged), 'Each bar is an interval that was handed in.')] if judged else []
    drawings = drawings_named(figures)
    environment = Environment(undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)  # noqa: S701 - Markdown
    environment.filters['plain'] = plain
    template = environment.from_string(resource_path('config', 'report', 'class.md').read_text(encoding='utf-8'))
    text = template.render(
        title=_TITLE,
        version=__version__,
        coverage=coverage_of(rows),
        rows=[row for row in rows if row['name'] is not None],
        drawings=drawings,
        parameters=[
            (item.description, item.unit, key)
            for item in describe(Plant)
            for key in (row_key(item.name, item.unit),)
            if key in rows[0]
        ],
    )
    return Document(title=_TITLE, text=text.strip() + '\n', drawings=drawings)


def row_key(name: str, unit: str) -> str:
    """Return under which name a row has a parameter of the plant."""
    plain_unit = unit.replace('1/s', 'per_s').replace('rad/s²', 'rad_s2')
    return f'{name}_{plain_unit}' if plain_unit else name


def _figure(rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Draw the intervals over the thresholds."""
    figure = blank('Intervals that were handed in, against the thresholds')
    [axes] = figure.axes
    for place, row in enumerate(rows):
        ends = [100.0 * (row[name] / row['truth_rpm'] - 1.0) for name in ('low_rpm', 'high_rpm', 'omega_crit_rpm')]
        color = _HOLDS if row['covered'] else _MISSES
        axes.plot([place, place], ends[:2], color=color, linewidth=2)
        axes.plot(place, ends[2], 'o', color=color)
    axes.axhline(0.0, color=_INK, linewidth=0.8)
    axes.set_xticks(range(len(rows)), [str(row['bench']) for row in rows], fontsize=7)
    axes.set(xlabel='bench', ylabel='deviation from the threshold (%)')
    return figure
