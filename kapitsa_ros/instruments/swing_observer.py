"""What an eye sees of the pendulum: that it is held and let go, and when it passes upright; no chance plays a part."""

from __future__ import annotations

import math
from copy import copy
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np

from kapitsa_ros.instruments.persistence_filter import PersistenceFilter

if TYPE_CHECKING:
    from kapitsa_ros.physics.sampled_motion import SampledMotion

_STILL = 1e-6  # rad; a pendulum in somebody's hand, stuck, or at its stop moves less than this
_LYING = 1.0  # rad; what is still beyond this has fallen over


@dataclass(frozen=True, kw_only=True, slots=True)
class SwingSight:
    """What is seen of the pendulum in one communication step; times in seconds of the run."""

    start: float
    end: float
    taken: bool
    """A hand has moved it since the step before, or nothing joins this one to it."""
    let_go: bool
    """It was held still, and now it moves."""
    lying: bool
    """It has fallen over."""
    passages: tuple[float, ...]
    """When it passed upright, of a swing that was seen to be let go: known some time later, for the eye blurs."""


class SwingObserver:
    """Follows the pendulum block by block; a copy goes on by itself.

    Parameters
    ----------
    persistence
        Of the eye: standard deviation of the blur, s.

    """

    def __init__(self, persistence: float) -> None:
        self._persistence = persistence
        self._end = math.nan
        self._period = math.nan
        self._angle = math.nan
        self._held = False
        self._eye: PersistenceFilter | None = None
        self._seen = math.nan
        self._seen_at = math.nan

    def __copy__(self) -> Self:
        """Return an observer that has seen the same."""
        other = object.__new__(type(self))
        other.__dict__ = {**self.__dict__, '_eye': copy(self._eye)}
        return other

    def observe(self, start: float, motion: SampledMotion) -> SwingSight:
        """Watch the pendulum for one communication step.

        Parameters
        ----------
        start
            Seconds of the run at the block's first sample; after a gap, or with other samples, all begins anew.
        motion
            Of the pendulum, rad from upright.

        """
        end, period, angles = start + motion.duration, motion.period, motion.position
        joined = abs(start - self._end) <= period and math.isclose(period, self._period, rel_tol=1e-9)
        still = bool(angles.max() - angles.min() <= _STILL)
        taken = not joined or bool(abs(angles[0] - self._angle) > _STILL)
        let_go = not taken and self._held and not still
        if taken:
            self._held, self._eye = still, None
        elif let_go:
            self._held = False
            self._seen = float(angles[0])
            self._eye = PersistenceFilter(self._persistence, period, self._seen)
            self._seen_at = start - self._eye.latency
        self._end, self._period, self._angle = end, period, float(angles[-1])
        return SwingSight(
            start=start,
            end=end,
            taken=taken,
            let_go=let_go,
            lying=still and abs(self._angle) > _LYING,
            passages=() if self._eye is None else self._passages(self._eye, start, motion),
        )

    def _passages(self, eye: PersistenceFilter, start: float, motion: SampledMotion) -> tuple[float, ...]:
        blurred = np.concatenate(((self._seen,), eye.see(motion.position[1:])))
        upright = np.signbit(blurred)
        passages = []
        for index in np.flatnonzero(upright[1:] != upright[:-1]).tolist():
            before, after = float(blurred[index]), float(blurred[index + 1])
            left = self._seen_at if index == 0 else start + index * motion.period - eye.latency
            right = start + (index + 1) * motion.period - eye.latency
            passages.append(left + (right - left) * before / (before - after))
        self._seen, self._seen_at = float(blurred[-1]), self._end - eye.latency
        return tuple(passages)
