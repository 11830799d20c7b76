"""How figures look, and their files."""

from __future__ import annotations

from matplotlib.figure import Figure

INK, BLUE, ORANGE, GREY = '#222222', '#0072b2', '#d55e00', '#999999'  # distinct to every eye


def blank(title: str, panels: int = 1, *, stacked: bool = False) -> Figure:
    """Return an empty figure with a title and panels side by side, or stacked; no window or backend is involved."""
    rows, columns = (panels, 1) if stacked else (1, panels)
    figure = Figure(figsize=(5.6 * columns, 4.0 * rows), layout='constrained', dpi=150)
    figure.suptitle(title, fontsize=11)
    for axes in figure.subplots(rows, columns, squeeze=False).flat:
        axes.grid(color='#e5e5e5', linewidth=0.6)
        axes.set_axisbelow(True)
    return figure
