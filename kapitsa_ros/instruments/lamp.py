"""The strobe lamp over the mark on the pivot, as somebody sees it who turns its dial."""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros.instruments.errors import InstrumentError
from kapitsa_ros.instruments.strobe_images import distinct_images
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.instruments.strobe_settings import StrobeSettings
    from kapitsa_ros.physics.sampled_motion import SampledMotion

AFTERIMAGE = 0.12
"""Seconds for which an eye still sees what a flash showed it."""
_THICKNESS = 0.002
"""Of the mark, share of the stroke: however sharp the eye, images closer than this lie over each other."""
_KEPT = 2.0
"""Seconds for which flashes are kept: blocks may be known before they are looked at."""
_NO_FLASH = np.empty(0)


class Lamp:
    """Flashes on the moving mark, and keeps what each flash showed.

    Nothing is assumed of the shaft: whether images stand, creep or blur, and how many there are, follows from where the
    mark is when the lamp flashes.

    Parameters
    ----------
    settings
        Its `dial_error`, `dial_end` and `mark_width` are used.
    amplitude
        Half the stroke of the pivot, m.

    """

    def __init__(self, settings: StrobeSettings, amplitude: float) -> None:
        self._settings = settings
        self._amplitude = amplitude
        self._end = -math.inf
        self.flash_rate = 0.0
        """rad/s of flashes; 0: the lamp is off."""
        self._last: float
        self._blocks: deque[tuple[float, NDArray[np.float64], NDArray[np.float64]]] = deque()
        """End of each block, and its flashes: their times and heights; a block is done with as a whole."""
        self._darken()

    def turn(self, dial: float) -> None:
        """Set the lamp so that its dial points at a value, rad/s of flashes; 0 turns it off.

        Raises
        ------
        InstrumentError
            The dial does not go so far.

        """
        if not 0.0 <= dial <= self._settings.dial_end:
            raise InstrumentError(f'the dial of the lamp goes from 0 to {self._settings.dial_end / RPM:.0f} a minute')
        self.flash_rate = dial / (1.0 + self._settings.dial_error)

    def shine(self, start: float, pivot: SampledMotion) -> None:
        """Flash during one communication step.

        Parameters
        ----------
        start
            Seconds of the run at the block's first sample; after a gap the lamp begins anew.
        pivot
            Motion of the pivot, m, on which the mark rides.

        """
        if abs(start - self._end) > pivot.period:
            self._darken()
        self._end = start + pivot.duration
        if self.flash_rate == 0.0:
            return
        period = 2.0 * math.pi / self.flash_rate
        first = max(self._last + period, start)
        count = max(0, math.ceil((self._end - first) / period))
        times = first + period * np.arange(count, dtype=float)
        if not times.size:
            return
        self._last = float(times[-1])
        heights = mark_heights(pivot, times - start) / self._amplitude
        while self._blocks and self._blocks[0][0] <= self._end - _KEPT:
            self._blocks.popleft()
        self._blocks.append((self._end, times, heights))

    def picture(self, now: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return what an eye sees.

        Parameters
        ----------
        now
            Seconds of the run.

        Returns
        -------
        heights, shares
            Shape (images,) each, as of `distinct_images`: of the flashes still seen. Empty where there were none.

        """
        times, heights = self._since(now - AFTERIMAGE)
        seen = (times <= now) & (times > now - AFTERIMAGE)
        return distinct_images(heights[seen], max(self._settings.mark_width, _THICKNESS))

    def flashes(self, start: float, end: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return when the lamp flashed, and what each flash showed.

        Parameters
        ----------
        start, end
            Seconds of the run, the end not included; flashes are kept for two seconds.

        Returns
        -------
        times, heights
            Shape (flashes,) each: s of the run; of the mark, in amplitudes from mid-stroke.

        """
        times, heights = self._since(start)
        within = (times >= start) & (times < end)
        return times[within], heights[within]

    def _since(self, start: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return times and heights of the flashes of all blocks that end later."""
        blocks = [block for block in self._blocks if block[0] > start]
        if len(blocks) == 1:
            return blocks[0][1:]
        times, heights = ([block[i] for block in blocks] for i in (1, 2))
        return np.concatenate([_NO_FLASH, *times]), np.concatenate([_NO_FLASH, *heights])

    def _darken(self) -> None:
        self._last = -math.inf
        self._blocks.clear()


def mark_heights(pivot: SampledMotion, times: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """Return where the mark is, m, at times within a block, s from its beginning: by cubic Hermite interpolation."""
    place = times / pivot.period
    before = np.minimum(np.maximum(place.astype(int), 0), pivot.position.size - 2)
    part = place - before
    rest = 1.0 - part
    low, high = pivot.position[before], pivot.position[before + 1]
    low_rate, high_rate = pivot.period * pivot.rate[before], pivot.period * pivot.rate[before + 1]
    heights: NDArray[np.float64] = rest * rest * ((1.0 + 2.0 * part) * low + part * low_rate) + part * part * (
        (1.0 + 2.0 * rest) * high - rest * high_rate
    )
    return heights
