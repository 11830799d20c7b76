"""How long a step of the power series may be."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kapitsa_ros.physics.parameters import PlantParameters

LONGEST_STEP = math.pi / 4  # in units of the fastest rate at work; order 16 then leaves out about 1e-16


def longest_step(plant: PlantParameters, speed: float) -> float:
    """Return the longest step for a cosine drive, s: short against forcing, restoring torque and damping alike."""
    stiffness = plant.k * (plant.gravity + plant.amplitude * speed**2)
    return LONGEST_STEP / max(speed, 2.0 * math.sqrt(stiffness), plant.damping)


def steps_per_turn(plant: PlantParameters, speed: float) -> int:
    """Return how many steps to take in a turn of the shaft: a power of two, so that phases are exact."""
    fewest = 2.0 * math.pi / speed / longest_step(plant, speed)
    return 1 << math.ceil(math.log2(fewest) - 1e-12)
