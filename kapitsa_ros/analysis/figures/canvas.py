"""How figures look, and their files."""

from __future__ import annotations

from matplotlib.figure import Figure

INK, BLUE, ORANGE, GREEN, GREY = '#222222', '#0072b2', '#d55e00', '#009e73', '#999999'  # distinct to every eye


def blank(title: str, panels: int = 1) -> Figure:
    """Return an empty figure with a title and panels side by side; no window or backend is involved."""
    figure = Figure(figsize=(5.6 * panels, 4.0), layout='constrained', dpi=150)
    figure.suptitle(title, fontsize=11)
    for axes in figure.subplots(1, panels, squeeze=False)[0]:
        axes.grid(color='#e5e5e5', linewidth=0.6)
        axes.set_axisbelow(True)
    return figure
