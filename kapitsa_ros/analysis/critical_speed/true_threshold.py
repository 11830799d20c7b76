"""The critical speed that a simulated plant really has."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kapitsa_ros.physics.theory.floquet import omega_crit_exact
from kapitsa_ros.physics.theory.play import effective_amplitude

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant


def true_threshold(plant: Plant) -> float:
    """Return the exact threshold at the stroke that the rod feels, rad/s.

    Play widens the stroke of the hole beyond the pin's, to first order by (2/π)·D, so a worn pivot holds the rod up at
    a lower speed than a tight one.
    """
    return omega_crit_exact(replace(plant, amplitude=effective_amplitude(plant)))
