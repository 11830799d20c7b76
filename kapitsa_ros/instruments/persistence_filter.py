"""The eye's persistence: it follows the slow swing and blurs the forcing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_REACH = 5.0  # standard deviations of the Gaussian that are kept on either side


class PersistenceFilter:
    """A symmetric Gaussian blur of a sampled motion that comes in blocks.

    The forcing modulates the swing by lines at ω ± Ω that are not of equal size, and so shifts raw passages through
    upright by up to 0.6 ms; blurred ones it leaves alone. Being symmetric, the blur delays nothing: values are merely
    known `latency` seconds late.

    Parameters
    ----------
    persistence
        Standard deviation of the blur, s.
    period
        Sample period, s.
    resting
        Angle at which the motion rested before, rad.

    """

    def __init__(self, persistence: float, period: float, resting: float) -> None:
        half = int(np.ceil(_REACH * persistence / period))
        offsets = np.arange(-half, half + 1) * period
        weights = np.exp(-0.5 * (offsets / max(persistence, np.finfo(np.float64).tiny)) ** 2)
        self._weights = weights / weights.sum()
        self._recent = np.full(2 * half, resting)
        self.latency = half * period
        """How long after a moment its blurred value is known, s."""

    def see(self, samples: NDArray[np.float64]) -> NDArray[np.float64]:
        """Blur the next samples.

        Parameters
        ----------
        samples
            Shape (N,), those that follow the last ones seen.

        Returns
        -------
        NDArray
            Shape (N,): the blurred motion `latency` seconds before each of them.

        """
        motion = np.concatenate((self._recent, samples))
        self._recent = motion[samples.size :]
        return np.convolve(motion, self._weights, mode='valid')
