# ruff: noqa: PLR0917 (compiled functions take their arrays by position)
"""Many rods at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.kernels.cosine import advance_cosine
from kapitsa_ros.physics.kernels.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray


@kernel
def advance_batch(
    amplitude: float,
    speed: NDArray[np.float64],
    start: NDArray[np.float64],
    step: NDArray[np.float64],
    stride: NDArray[np.float64],
    plant: NDArray[np.float64],
    states: NDArray[np.float64],
    truncation: NDArray[np.float64],
    motion: NDArray[np.float64],
    work: NDArray[np.float64],
) -> None:
    """Carry each row of `states` through `stride` steps; arguments as of `advance_cosine`, one entry a rod.

    `motion` and `work` are work space, of shape (2, 2) and `cosine.WORK_SHAPE`.
    """
    for rod in range(states.shape[0]):
        turns = speed[rod] * step[rod] / (2.0 * np.pi)
        truncation[rod] = advance_cosine(
            amplitude, speed[rod], start[rod], step[rod], turns, int(stride[rod]), plant, states[rod], motion, work
        )
