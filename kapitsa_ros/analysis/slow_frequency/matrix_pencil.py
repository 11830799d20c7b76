"""The matrix pencil method: the strongest damped oscillation of a short record, without a guess."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_LONGEST = 200  # rows and columns beyond which a singular value decomposition buys nothing more
_FEWEST = 8  # samples a period: further apart they would lose its phase


def strongest_pole(samples: NDArray[np.float64], period: float) -> complex:
    """Return −γ + iΩ of the strongest oscillation in equidistant samples (Hua & Sarkar, IEEE ASSP 38, 814 (1990)).

    Of a record of more than a hundred periods it is that of its beginning.

    Parameters
    ----------
    samples
        Shape (N,), N at least 6.
    period
        Seconds between them.

    """
    periods = 1 + int(np.argmax(np.abs(np.fft.rfft(samples)[1:])))
    stride = max(1, min(samples.size // (2 * _LONGEST), samples.size // (_FEWEST * periods)))
    used = min(samples.size // stride, 4 * _LONGEST) * stride
    thinned = samples[:used].reshape(-1, stride).mean(axis=1)
    length = thinned.size // 2
    hankel = np.lib.stride_tricks.sliding_window_view(thinned, length)
    signal = np.linalg.svd(hankel, full_matrices=False)[2][:2].T
    pole = np.linalg.eigvals(np.linalg.lstsq(signal[:-1], signal[1:], rcond=None)[0])
    return complex(np.log(pole[np.argmax(pole.imag)] + 0j) / (stride * period))
