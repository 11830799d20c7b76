"""The matrix pencil method: the strongest damped oscillation of a short record, without a guess."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_LONGEST = 200  # rows and columns beyond which a singular value decomposition buys nothing more


def strongest_pole(samples: NDArray[np.float64], period: float) -> complex:
    """Return −γ + iΩ of the strongest oscillation in equidistant samples (Hua & Sarkar, IEEE ASSP 38, 814 (1990)).

    Parameters
    ----------
    samples
        Shape (N,), N at least 6.
    period
        Seconds between them.

    """
    stride = max(1, samples.size // (2 * _LONGEST))
    thinned = samples[: samples.size // stride * stride].reshape(-1, stride).mean(axis=1)
    length = thinned.size // 2
    hankel = np.lib.stride_tricks.sliding_window_view(thinned, length)
    signal = np.linalg.svd(hankel, full_matrices=False)[2][:2].T
    pole = np.linalg.eigvals(np.linalg.lstsq(signal[:-1], signal[1:], rcond=None)[0])
    return complex(np.log(pole[np.argmax(pole.imag)] + 0j) / (stride * period))
