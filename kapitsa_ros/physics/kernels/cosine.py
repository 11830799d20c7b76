# ruff: noqa: PLR0917 (compiled functions take their arrays by position)
"""The rod on a pivot that moves as a pure cosine, in steps that divide the time between samples."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kapitsa_ros.physics.kernels.jit import kernel
from kapitsa_ros.physics.kernels.layout import ANGLE, GRAVITY, RATE
from kapitsa_ros.physics.kernels.rod import ANGLE_SERIES, WORK_ROWS, advance_interval

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ORDER = 16
TOO_MANY_EVENTS = -1.0
WORK_SHAPE = (WORK_ROWS + 2, ORDER + 1)


@kernel
def advance_cosine(
    amplitude: float,
    speed: float,
    start: float,
    step: float,
    turns: float,
    stride: int,
    plant: NDArray[np.float64],
    state: NDArray[np.float64],
    motion: NDArray[np.float64],
    work: NDArray[np.float64],
) -> float:
    """Carry the state through samples that are `stride` steps apart.

    Parameters
    ----------
    amplitude, speed
        λ (m) and ω (rad/s).
    start
        Phase of the pivot at the first sample, turns from the bottom.
    step, turns
        One step in seconds and in turns of the shaft: turns = ω step / 2π, exact where it is a power of two.
    stride
        Steps from one sample to the next.
    plant, state
        As `layout` has them; `state` is changed in place.
    motion
        θ and θ′ on return, shape (2, samples).
    work
        Work space, of WORK_SHAPE.

    Returns
    -------
    float
        The largest last term of the series met, rad: the truncation error of one step; TOO_MANY_EVENTS where events
        could not be resolved.

    """
    load, drive_terms = work[WORK_ROWS, : ORDER - 1], work[WORK_ROWS + 1, : ORDER - 1]
    fill_drive_terms(amplitude, speed, step, turns, drive_terms)
    weight = plant[GRAVITY] * step * step
    motion[0, 0] = state[ANGLE]
    motion[1, 0] = state[RATE]
    truncation = 0.0
    for sample in range(1, motion.shape[1]):
        for i in range((sample - 1) * stride, sample * stride):
            cosine, sine = at_phase(i * turns, start)
            fill_load(cosine, sine, drive_terms, weight, load)
            if not advance_interval(load, 0.0, step, plant, state, work):
                return TOO_MANY_EVENTS
            truncation = max(truncation, abs(work[ANGLE_SERIES, -1]))
        motion[0, sample] = state[ANGLE]
        motion[1, sample] = state[RATE]
    return truncation


@kernel
def fill_drive_terms(
    amplitude: float, speed: float, step: float, turns: float, drive_terms: NDArray[np.float64]
) -> None:
    """Fill in what the load's coefficients have in common at all phases: h²λω² δⁿ/n!, δ the phase of a step."""
    term = amplitude * (speed * step) ** 2
    for n in range(drive_terms.size):
        drive_terms[n] = term if n % 4 in (0, 3) else -term
        term *= 2.0 * math.pi * turns / (n + 1)


@kernel
def at_phase(turn: float, start: float) -> tuple[float, float]:
    """Return cosine and sine of a phase in turns."""
    phase = 2.0 * math.pi * (turn - math.floor(turn) + start)
    return math.cos(phase), math.sin(phase)


@kernel
def fill_load(
    cosine: float,
    sine: float,
    drive_terms: NDArray[np.float64],
    weight: float,
    load: NDArray[np.float64],
) -> None:
    """Fill in the coefficients of h² (g + y″) from a phase on."""
    for n in range(0, load.size, 2):
        load[n] = drive_terms[n] * cosine
    for n in range(1, load.size, 2):
        load[n] = drive_terms[n] * sine
    load[0] += weight
