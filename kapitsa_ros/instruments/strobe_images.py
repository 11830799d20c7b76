"""What a person sees of the registration mark in the light of a strobe lamp."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.instruments.errors import InstrumentError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.instruments.strobe_settings import StrobeSettings

_ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class StrobeImages:
    """The images of one mark at one flash rate."""

    flash_phases: int
    """p: flashes until the mark is lit in the same place again; 0 where nothing stands still."""
    revolutions: int
    """q: turns of the shaft between those flashes."""
    drift: float
    """rad/s at which the phase of the images creeps."""
    heights: NDArray[np.float64]
    """Shape (images,): where they stand, in amplitudes from mid-stroke, ascending."""
    shares: NDArray[np.float64]
    """Shape (images,): share of the flashes that falls on each, its contrast."""

    @property
    def images(self) -> int:
        """How many images stand still: 1 single, 2 doubled, 3 tripled..., 0 a blur."""
        return self.heights.size


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
    return distinct_images(-np.cos(phase + 2.0 * np.pi * np.arange(flash_phases) / flash_phases), mark_width)


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
    apart = np.flatnonzero(np.diff(lit) > 2.0 * mark_width + _ROUNDING) + 1
    groups = np.split(lit, apart)
    return np.array([group.mean() for group in groups]), np.array([group.size / lit.size for group in groups])


def look(flash_rate: float, shaft_speed: float, phase: float, eye: StrobeSettings) -> StrobeImages:
    """Show what is seen at any flash rate.

    At (p/q)·ω the mark is lit at p phases of the shaft. Nearby, those phases creep at ω − (q/p)·flash rate, and the
    picture stands still for an eye that does not notice so slow a drift. Many phases share the light among too many
    images: each is then too faint to be seen.

    Parameters
    ----------
    flash_rate, shaft_speed
        rad/s, above 0.
    phase
        Phase of the shaft at one of the flashes, rad.
    eye
        Its `drift_limit`, `mark_width` and `contrast_limit` are used.

    Raises
    ------
    InstrumentError
        A rate is not a positive number.

    """
    if not (0.0 < flash_rate < math.inf and 0.0 < shaft_speed < math.inf):
        raise InstrumentError(f'flash rate {flash_rate}, shaft speed {shaft_speed}: both must be positive')
    for p in range(1, faintest(eye) + 1):
        q = max(1, round(p * shaft_speed / flash_rate))
        drift = shaft_speed - q * flash_rate / p
        if abs(drift) <= eye.drift_limit + _ROUNDING * shaft_speed:
            heights, shares = standing_images(p, phase, eye.mark_width)
            return StrobeImages(flash_phases=p, revolutions=q, drift=drift, heights=heights, shares=shares)
    return StrobeImages(flash_phases=0, revolutions=0, drift=math.inf, heights=np.empty(0), shares=np.empty(0))


def faintest(eye: StrobeSettings) -> int:
    """Return the largest number of flash phases whose images are still bright enough to be seen."""
    return math.floor(1.0 / eye.contrast_limit + _ROUNDING)
