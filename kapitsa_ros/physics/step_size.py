"""How long a step of the power series may be, and how many samples a run has."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kapitsa_ros.physics.errors import ParameterError
from kapitsa_ros.physics.limits import MOST_SAMPLES

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant

LONGEST_STEP = math.pi / 4  # in units of the fastest rate at work; order 16 then leaves out about 1e-16


def longest_step(plant: Plant, speed: float) -> float:
    """Return the longest step for a cosine drive, s: short against forcing, restoring torque and damping alike."""
    stiffness = plant.k * (plant.gravity + plant.amplitude * speed**2)
    return LONGEST_STEP / max(speed, 2.0 * math.sqrt(stiffness), plant.damping)


def steps_per_turn(plant: Plant, speed: float) -> int:
    """Return how many steps to take in a turn of the shaft: a power of two, so that phases are exact."""
    fewest = 2.0 * math.pi / speed / longest_step(plant, speed)
    return 1 << math.ceil(math.log2(fewest) - 1e-12)


def whole_samples(duration: float, sample_rate: float) -> int:
    """Return how many sample periods fit into a duration.

    Raises
    ------
    ParameterError
        Not one, more than memory holds, or a value is not finite.

    """
    if 0 < sample_rate < math.inf and 0 < duration < math.inf:
        count = duration * sample_rate * (1.0 + 1e-12)
        if not count < MOST_SAMPLES + 1:  # infinite, it may be
            raise ParameterError(
                f'{duration} s at {sample_rate} Hz: more than {MOST_SAMPLES:,} samples, reduce duration or sample_rate'
            )
        if count >= 1:
            return math.floor(count)
    raise ParameterError(f'{duration} s at {sample_rate} Hz: give a duration of one sample period or more')
