# ruff: noqa: PLR0917 (compiled functions take their arrays by position)
"""Many rods at once, on all cores."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numba
import numpy as np

from kapitsa_ros.physics.kernels.cosine import advance_cosine
from kapitsa_ros.physics.kernels.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray


@partial(kernel, parallel=True)
def advance_batch(
    amplitude: float,
    speed: NDArray[np.float64],
    start: NDArray[np.float64],
    step: NDArray[np.float64],
    stride: NDArray[np.int64],
    plant: NDArray[np.float64],
    states: NDArray[np.float64],
    truncation: NDArray[np.float64],
) -> None:
    """Carry each row of `states` through `stride` steps; arguments as of `advance_cosine`, one entry a rod."""
    for rod in numba.prange(states.shape[0]):
        motion = np.empty((2, 2))
        turns = speed[rod] * step[rod] / (2.0 * np.pi)
        truncation[rod] = advance_cosine(
            amplitude, speed[rod], start[rod], step[rod], turns, stride[rod], plant, states[rod], motion
        )
