"""How fast the shaft turns, and since when it turns steadily, from the motion of the pivot."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from kapitsa_ros.physics.sampled_motion import SampledMotion

_STEADY = 1e-7  # relative; what the crossings of a steady shaft may scatter by
_AT_REST = 2.0  # seconds without a revolution


class SteadySpeedDetector:
    """Follows the upward passages of the pivot through mid-stroke, one a revolution.

    Parameters
    ----------
    tolerance
        Changes of speed below this, rad/s, count as none.

    """

    def __init__(self, tolerance: float) -> None:
        self._tolerance = tolerance
        self._end = -math.inf
        self._forget()

    def _forget(self) -> None:
        self.steady_since: float | None = None
        """When the shaft was first seen to be steady, s; None while it is not."""
        self.speed = 0.0
        """Mean speed since then, rad/s."""
        self._passage: float | None = None
        self._block_speed = 0.0
        self._turns = 0

    def follow(self, start: float, pivot: SampledMotion) -> None:
        """Take in the next block of the pivot's motion; one that does not join the last begins anew."""
        if abs(start - self._end) > pivot.period:
            self._forget()
        self._end = start + pivot.duration
        upward = np.flatnonzero((pivot.position[:-1] < 0.0) & (pivot.position[1:] >= 0.0))
        if upward.size:
            index = int(upward[-1])
            self._revolve(start + (index + _passage(pivot, index)) * pivot.period, upward.size)
        elif self._passage is not None and self._end - self._passage > _AT_REST:
            self._forget()

    def _revolve(self, passage: float, turns: int) -> None:
        if self._passage is not None:
            speed = 2.0 * math.pi * turns / (passage - self._passage)
            known = self._block_speed if self.steady_since is None or not self._turns else self.speed
            if abs(speed - known) > max(self._tolerance, _STEADY * speed):
                self.steady_since = None
            elif self.steady_since is None:
                self.steady_since, self._turns, self.speed = passage, 0, speed
            else:
                self._turns += turns
                self.speed = 2.0 * math.pi * self._turns / (passage - self.steady_since)
            self._block_speed = speed
        self._passage = passage


def _passage(motion: SampledMotion, index: int) -> float:
    """Solve for the zero of the quintic Hermite interpolant after sample `index`, in sample periods."""
    h = motion.period
    y0, y1 = (float(value) for value in motion.position[index : index + 2])
    v0, v1 = (float(value) * h for value in motion.rate[index : index + 2])
    a0, a1 = (float(value) * h * h for value in motion.acceleration[index : index + 2])
    rise, slope, bend = y1 - y0 - v0 - a0 / 2.0, v1 - v0 - a0, a1 - a0
    c3 = 10.0 * rise - 4.0 * slope + bend / 2.0
    c4 = -15.0 * rise + 7.0 * slope - bend
    c5 = 6.0 * rise - 3.0 * slope + bend / 2.0
    u = y0 / (y0 - y1)
    for _ in range(4):  # Newton from the chord: the arc is nearly straight within a sample
        value = y0 + u * (v0 + u * (a0 / 2.0 + u * (c3 + u * (c4 + u * c5))))
        rate = v0 + u * (a0 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)))
        u = min(max(u - value / rate, 0.0), 1.0) if rate > 0.0 else u
    return u
