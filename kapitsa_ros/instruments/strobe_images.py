"""What a person sees of the registration mark in the light of a strobe lamp."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.instruments.strobe_settings import StrobeSettings

_ROUNDING = 1e-9


def standing_images(
    flash_phases: int, phase: float, mark_width: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Place the images of a mark that p equidistant phases of the shaft light up, and count the flashes on each.

    The mark rides on the pivot at height −cos φ (in amplitudes). The images at φ and −φ coincide, for a slider-crank
    as for a cosine: so three or four phases can look doubled, and two can look single.

    Parameters
    ----------
    flash_phases
        p, 1 or more.
    phase
        Phase of the shaft at one of the flashes, rad (0: the bottom of the stroke).
    mark_width
        Images closer than this share of the stroke look like one.

    Returns
    -------
    heights, shares
        Shape (images,) each: amplitudes from mid-stroke, ascending; share of the flashes.

    """
    return distinct_images(_lit(flash_phases, phase), mark_width)


def number_of_images(flash_phases: int, phase: float, mark_width: float) -> int:
    """Return how many images `standing_images` places."""
    return 1 + int(np.count_nonzero(_apart(np.sort(_lit(flash_phases, phase)), mark_width)))


def _lit(flash_phases: int, phase: float) -> NDArray[np.float64]:
    return np.asarray(-np.cos(phase + 2.0 * np.pi * np.arange(flash_phases) / flash_phases))


def _apart(lit: NDArray[np.float64], mark_width: float) -> NDArray[np.bool_]:
    """Tell of which heights, ascending, the next is another image."""
    return np.asarray(lit[1:] - lit[:-1] > 2.0 * mark_width + _ROUNDING)


def distinct_images(lit: NDArray[np.float64], mark_width: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Take flashes on the mark that no eye can tell apart for one image.

    Parameters
    ----------
    lit
        Shape (N,): height of the mark at each flash, in amplitudes from mid-stroke.
    mark_width
        Flashes closer than this share of the stroke look like one image.

    Returns
    -------
    heights, shares
        Shape (images,) each: amplitudes from mid-stroke, ascending; share of the flashes.

    """
    if not lit.size:
        return np.empty(0), np.empty(0)
    lit = np.sort(lit)
    apart = np.flatnonzero(_apart(lit, mark_width)) + 1
    groups = np.split(lit, apart)
    return np.array([group.mean() for group in groups]), np.array([group.size / lit.size for group in groups])


def faintest(eye: StrobeSettings) -> int:
    """Return the largest number of flash phases whose images are still bright enough to be seen."""
    return math.floor(1.0 / eye.contrast_limit + _ROUNDING)
