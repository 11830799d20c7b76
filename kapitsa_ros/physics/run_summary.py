"""What a run's slow motion does: its frequency, its growth, and how often it swings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.flexible_rod import simulate_flexible
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact
from kapitsa_ros.physics.theory.floquet_amplitude import mean_growth, mean_turn, slow_amplitude
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.physics.flexible_rod import BendingMode, FlexibleTrajectory
    from kapitsa_ros.physics.release import Release, Trajectory

SMALL = 0.3  # rad: a falling rod is watched up to here, while its equation is nearly linear
ALIVE = 0.2  # of the first slow amplitude: below, friction decides where it comes to rest


@dataclass(frozen=True, kw_only=True)
class RunSummary:
    """The slow motion of one run; None for what it does not have."""

    frequency: float | None
    """Ω, rad/s: the rotation number for a frictionless rod, else the mean while it swings."""
    growth: float | None
    """Of the slow amplitude, 1/s: the mean of d ln A/dt while it swings, or while it begins to fall."""
    periods: float | None
    """Slow periods swung."""


def summarise_run(release: Release, duration: float, bending: BendingMode | None = None) -> RunSummary:
    """Watch a run through a stroboscope at the bottoms of the stroke.

    Parameters
    ----------
    release
        The run.
    duration
        How long it is watched, s; fewer than three turns of the shaft show nothing of the growth.
    bending
        The mode of a rod that bends: its frequency is the mean while it swings.

    """
    plant, speed = release.plant, release.speed
    turn = 2.0 * math.pi / speed
    turns = max(math.floor(duration / turn) - 1, 0)
    if bending is None:
        orbit: Trajectory | FlexibleTrajectory = release.strobed(turns)
    else:  # once a turn, though not at the bottom: that neither turns nor stretches the slow motion
        orbit = simulate_flexible(release, bending, max(turns, 1) * turn, 1.0 / turn)
    amplitude = slow_amplitude(plant, speed, orbit.angle, orbit.rate)
    swinging = amplitude[
        : _end(np.abs(orbit.angle) < SMALL if orbit.fell else np.abs(amplitude) > ALIVE * abs(amplitude[0]))
    ]
    growth = mean_growth(swinging) / turn if swinging.size > 2 else None
    if orbit.fell or release.angle == 0:
        return RunSummary(frequency=None, growth=growth, periods=None)

    rigid = bending is None
    if rigid and release.linear and plant.linearly_damped:
        frequency = slow_frequency_exact(plant, speed)
    elif rigid and plant.conservative:
        frequency = slow_frequency_nonlinear(plant, speed, release.angle, release.phase)
    else:
        frequency = mean_turn(swinging) / turn if swinging.size > 2 else None
    if frequency is None:
        return RunSummary(frequency=None, growth=growth, periods=None)
    watched = duration if swinging.size == amplitude.size else swinging.size * turn
    return RunSummary(frequency=frequency, growth=growth, periods=frequency * watched / (2.0 * math.pi))


def _end(holds: NDArray[np.bool_]) -> int:
    """Return where a condition first fails."""
    return holds.size if holds.all() else int(np.argmin(holds))
