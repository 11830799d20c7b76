"""The outcomes of many experiments, a number of bytes each: a campaign may have a hundred thousand."""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from kapitsa_ros.laboratory.campaign import Outcome


class Outcomes:
    """Outcomes by column, in the order in which they came; speeds in rad/s.

    Parameters
    ----------
    outcomes
        The first ones.

    """

    def __init__(self, outcomes: Iterable[Outcome] = ()) -> None:
        self._seed = array('q')
        self._omega_crit, self._low, self._high = array('d'), array('d'), array('d')
        self._failures: dict[int, str] = {}
        self._reasons: dict[str, str] = {}
        self.seconds = 0.0
        """Of computing, of all together."""
        for outcome in outcomes:
            self.add(outcome)

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._seed)

    def add(self, outcome: Outcome) -> None:
        """Take in the next one."""
        if outcome.failure is not None:
            self._failures[len(self)] = self._reasons.setdefault(outcome.failure, outcome.failure)
        low, high = outcome.interval
        self._seed.append(outcome.seed)
        self._omega_crit.append(math.nan if outcome.omega_crit is None else outcome.omega_crit)
        self._low.append(-math.inf if low is None else low)
        self._high.append(math.inf if high is None else high)
        self.seconds += outcome.seconds

    @property
    def seed(self) -> NDArray[np.int64]:
        """Shape (N,)."""
        return np.array(self._seed, np.int64)

    @property
    def omega_crit(self) -> NDArray[np.float64]:
        """By the direct fit; nan where the readings gave none."""
        return np.array(self._omega_crit)

    @property
    def low(self) -> NDArray[np.float64]:
        """Lower end of the interval; -inf where it is unbounded."""
        return np.array(self._low)

    @property
    def high(self) -> NDArray[np.float64]:
        """Upper end; inf where it is unbounded."""
        return np.array(self._high)

    @property
    def failure(self) -> tuple[str | None, ...]:
        """Why there is no critical speed; None where there is one."""
        return tuple(map(self._failures.get, range(len(self))))
