"""The theories of the slow frequency, each compared with the full nonlinear one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kapitsa_ros.physics.theory.averaged import slow_frequency_averaged
from kapitsa_ros.physics.theory.expansion import slow_frequency_next_order
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact
from kapitsa_ros.physics.theory.large_swings import slow_frequency_large, slow_swing
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant


@dataclass(frozen=True, kw_only=True)
class TheoryResult:
    """One theory's answer."""

    name: str
    source: str
    """The equation or paper."""
    frequency: float | None
    """Ω, rad/s; None where it has none."""
    error: float | None
    """Less the truth, rad/s."""


def compare_theories(plant: Plant, speed: float, release: float, phase: float = 0.0) -> list[TheoryResult]:
    """Return the theories in order of accuracy for a frictionless rod let go at rest, the full nonlinear one last.

    Raises
    ------
    PhysicsError
        The rod does not swing round upright.

    """
    smooth = plant.without_losses()
    truth = slow_frequency_nonlinear(smooth, speed, release, phase)
    swing = slow_swing(smooth, speed, release, phase)
    answers = (
        ('averaged', 'report, eq. 15', slow_frequency_averaged(smooth, speed)),
        ('next order', 'DLMF 28.15.1', slow_frequency_next_order(smooth, speed)),
        ('exact, small swings', 'Floquet', slow_frequency_exact(smooth, speed)),
        ('effective potential', 'Butikov 2001', slow_frequency_large(smooth, speed, swing)),
        ('nonlinear truth', 'rotation number', truth),
    )
    return [
        TheoryResult(name=name, source=source, frequency=value, error=None if value is None else value - truth)
        for name, source, value in answers
    ]
