"""How figures look, and their files."""

from __future__ import annotations

import math
from contextlib import contextmanager
from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from matplotlib.axes import Axes

INK, BLUE, ORANGE, GREY = '#222222', '#0072b2', '#d55e00', '#999999'  # distinct to every eye
FORMATS = ('png', 'svg', 'pdf')
"""Of a figure's file; the format's name is its suffix too."""

_RAISED = str.maketrans('-0123456789', '⁻⁰¹²³⁴⁵⁶⁷⁸⁹')

# What a file would otherwise tell of the hour at which it was made.
_UNDATED = {'png': {}, 'svg': {'Date': None}, 'pdf': {'CreationDate': None}}


@contextmanager
def house_style() -> Iterator[None]:
    """Draw and save as matplotlib does of itself, whatever the user's matplotlibrc says; letters in files stay text."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(
            {
                'svg.fonttype': 'none',
                'svg.hashsalt': 'kapitsa_ros',
                'pdf.fonttype': 42,
                'text.parse_math': False,  # $ is a sign of a name here
            }
        )
        yield


def blank(title: str, panels: int = 1, *, stacked: bool = False) -> Figure:
    """Return an empty figure with a title and panels side by side, or stacked; no window or backend is involved."""
    rows, columns = (panels, 1) if stacked else (1, panels)
    figure = Figure(figsize=(5.6 * columns, 4.0 * rows), layout='constrained', dpi=150)
    figure.suptitle(title, fontsize=11)
    for axes in figure.subplots(rows, columns, squeeze=False).flat:
        axes.grid(color='#e5e5e5', linewidth=0.6)
        axes.set_axisbelow(True)
    return figure


def write_powers(axes: Axes) -> None:
    """Write the powers of ten at a logarithmic axis in plain signs: as formulas they take as long as the drawing."""
    axes.yaxis.set_major_formatter(lambda value, _: '10' + str(round(math.log10(value))).translate(_RAISED))
    axes.yaxis.set_minor_formatter(NullFormatter())


def save(figure: Figure, path: Path, kind: str) -> None:
    """Write a figure in one of the `FORMATS`: the same bytes for the same figure, on any day."""
    with house_style():
        figure.savefig(path, format=kind, metadata=_UNDATED[kind])
