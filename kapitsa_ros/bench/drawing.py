"""Drawings made of characters: the rod, the mark under the lamp, the graduations of a dial."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_DOTS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])
"""Bits of the eight dots of a braille character, rows by columns."""
_BRAILLE = 0x2800
_BARS = '▔━▁'
"""A bright image in the upper, middle and lower third of a line of text."""
_FAINT = '┈'


def draw_rod(angle: float, width: int, height: int) -> list[str]:
    """Draw the rod over its pivot at the middle of the bottom line.

    Parameters
    ----------
    angle
        From upright, rad; positive to the right.
    width, height
        Of the drawing, characters.

    """
    columns, rows = 2 * width, 4 * height
    dots = np.zeros((rows, columns), bool)
    middle, foot = (columns - 1) / 2, rows - 2.5
    length = min(foot, middle - 1)
    along = np.linspace(0.0, length, 4 * round(length) + 1)
    for shift in (0.0, 1.0):  # two dots thick
        across = np.rint(middle + along * math.sin(angle) + shift * math.cos(angle) - 0.5).astype(int)
        down = np.rint(foot - along * math.cos(angle) + shift * math.sin(angle) - 0.5).astype(int)
        inside = (across >= 0) & (across < columns) & (down >= 0) & (down < rows)
        dots[down[inside], across[inside]] = True
    dots[rows - 1, round(middle) - 6 : round(middle) + 7] = True
    cells = dots.reshape(height, 4, width, 2).transpose(0, 2, 1, 3)
    codes = _BRAILLE + (cells * _DOTS).sum(axis=(2, 3))
    return [''.join(chr(code) if code > _BRAILLE else ' ' for code in line) for line in codes]


def draw_ruler(angle: float, reach: float, width: int) -> str:
    """Draw a ruler behind the tip of the rod, from −reach to reach, rad; upright is in its middle."""
    middle = (width - 1) // 2
    at = round(middle + max(-1.0, min(1.0, angle / reach)) * middle)
    ruler = ['·'] * (2 * middle + 1)
    ruler[middle] = '┼'
    ruler[at] = '◆'
    return ''.join(ruler)


def draw_marks(
    heights: NDArray[np.float64], shares: NDArray[np.float64], faintest: float, width: int, rows: int
) -> list[tuple[str, bool]]:
    """Draw the images of the mark within its stroke.

    Parameters
    ----------
    heights, shares
        Shape (images,): in amplitudes from mid-stroke; share of the flashes on each.
    faintest
        Share below which an image is only a glimmer.
    width, rows
        Of the drawing, characters.

    Returns
    -------
    list of (str, bool)
        The lines from the top of the stroke to its bottom, and whether each shows a bright image.

    """
    lines = [(' ' * width, False)] * rows
    thirds = np.rint((1.0 - np.clip(heights, -1.0, 1.0)) / 2.0 * (3 * rows - 1)).astype(int)
    for third, share in sorted(zip(thirds.tolist(), shares.tolist(), strict=True), key=lambda image: image[1]):
        bright = share >= faintest
        lines[third // 3] = ((_BARS[third % 3] if bright else _FAINT) * width, bright)
    return lines


def draw_dial(value: float, graduation: float, width: int) -> tuple[str, str]:
    """Draw the needle of a dial over its graduations.

    Parameters
    ----------
    value, graduation
        Where it points, and the distance of two graduations; in any unit.
    width
        Of the drawing, characters.

    Returns
    -------
    needle, scale
        Two lines: the needle always stands in the middle, the scale moves.

    """
    middle = width // 2
    apart = 8
    offset = round((value / graduation - round(value / graduation)) * apart)
    scale = ['·' if (column - middle + offset) % apart else '|' for column in range(width)]
    return ' ' * middle + '▼' + ' ' * (width - middle - 1), ''.join(scale)
