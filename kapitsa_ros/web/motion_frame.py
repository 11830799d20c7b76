"""One communication step as the page draws it: the motion at its full rate, and the flashes of the lamp."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.physics.sampled_motion import SampledMotion

HEADER = struct.Struct('<IIddI')
"""Run, number of samples, start (s of the run), sample period (s), number of flashes."""


def encode_motion(
    run: int,
    start: float,
    pendulum: SampledMotion,
    pivot: SampledMotion,
    flashes: tuple[NDArray[np.float64], NDArray[np.float64]],
    *,
    scale: float = 1.0,
) -> bytes:
    """Put a step into a binary frame: `HEADER`, then float32 in little-endian order.

    Parameters
    ----------
    run
        Its number.
    start
        Of the step, s of the run.
    pendulum, pivot
        Angle, rad, and height, m; of one size.
    flashes
        Times, s of the run, and heights of the mark, in amplitudes.
    scale
        By which the heights of the pivot are told larger than they are.

    Returns
    -------
    bytes
        After the header: angles, heights, times since the start, heights of the mark.

    """
    times, heights = flashes
    parts = np.concatenate((pendulum.position, scale * pivot.position, times - start, heights))
    header = HEADER.pack(run, pendulum.position.size, start, pendulum.period, times.size)
    return header + parts.astype('<f4').tobytes()
