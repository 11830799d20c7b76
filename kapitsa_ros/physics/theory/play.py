"""Play at the pivot: the hole overshoots the pin, so play stiffens the slow motion."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from kapitsa_ros.physics.theory.floquet import slow_frequency_exact

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant


def effective_amplitude(plant: Plant) -> float:
    """Return λ_eff ≈ λ (1 + (2/π) D/λ), m: first order in D/λ, plastic impacts (e = 0), λω² ≫ g."""
    return plant.amplitude + 2.0 / math.pi * plant.clearance


def slow_frequency_with_play(plant: Plant, speed: float) -> float | None:
    """Return Ω, rad/s: the exact linear value at the effective amplitude."""
    return slow_frequency_exact(replace(plant, amplitude=effective_amplitude(plant)), speed)
