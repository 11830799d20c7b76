"""How a wider swing is a slower one, by averaged theory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.analysis.errors import AnalysisError

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant


def softening(plant: Plant, forcing: float) -> float:
    """Return s in Ω(A) = Ω(0)·(1 − s A²), A the amplitude of the slow swing in rad.

    Averaging the plant over the forcing leaves θ″ = G sin θ − H sin θ cos θ with G = kg and H = (kλω)²/2 (Kapitsa's
    effective potential). To third order it is a Duffing oscillator, Ω² = H − G, whose frequency falls by
    3αA²/(8Ω²) with α = 2H/3 − G/6.

    Raises
    ------
    AnalysisError
        The upright is not stable at this speed.

    """
    gravity, stiffness = plant.k * plant.gravity, 0.5 * (plant.k * plant.amplitude * forcing) ** 2
    if stiffness <= gravity:
        raise AnalysisError(f'{forcing} rad/s is below the critical speed: there is no swing about upright')
    return 0.375 * (2.0 * stiffness / 3.0 - gravity / 6.0) / (stiffness - gravity)
