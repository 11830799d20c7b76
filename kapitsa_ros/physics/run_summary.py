"""What a run's slow motion does: its frequency, its growth, and how often it swings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.flexible_rod import FlexibleTrajectory, simulate_flexible
from kapitsa_ros.physics.theory.floquet import is_stable, slow_frequency_exact
from kapitsa_ros.physics.theory.floquet_amplitude import mean_growth, mean_turn, slow_amplitude
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear
from kapitsa_ros.physics.theory.play import omega_crit_with_play

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.physics.flexible_rod import BendingMode
    from kapitsa_ros.physics.plant import Plant
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
    falls: bool
    """Whether it fell or would fall, if it were watched for longer: upright is not stable, or the release too wide."""


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
    held = isinstance(orbit, FlexibleTrajectory) or orbit.stuck
    falls = orbit.fell or not (held or _stands(plant, speed))
    swinging = amplitude[
        : _end(np.abs(orbit.angle) < SMALL if falls else np.abs(amplitude) > ALIVE * abs(amplitude[0]))
    ]
    growth = mean_growth(swinging) / turn if swinging.size > 2 else None
    frequency = None
    if not falls and release.angle != 0:
        try:
            frequency = _frequency(release, swinging, turn, rigid=bending is None)
        except PhysicsError:
            falls = True
    if frequency is None:
        return RunSummary(frequency=None, growth=growth, periods=None, falls=falls)
    watched = duration if swinging.size == amplitude.size else swinging.size * turn
    periods = frequency * watched / (2.0 * math.pi)
    return RunSummary(frequency=frequency, growth=growth, periods=periods, falls=False)


def _stands(plant: Plant, speed: float) -> bool:
    """Tell whether upright is stable; play lowers the threshold."""
    if is_stable(plant, speed) or plant.clearance == 0.0:
        return is_stable(plant, speed)
    try:
        return speed >= omega_crit_with_play(plant)
    except PhysicsError:
        return False


def _frequency(release: Release, swinging: NDArray[np.complex128], turn: float, *, rigid: bool) -> float | None:
    if rigid and release.linear and release.plant.linearly_damped:
        return slow_frequency_exact(release.plant, release.speed)
    if rigid and release.plant.conservative:
        return slow_frequency_nonlinear(release.plant, release.speed, release.angle, release.phase)
    if swinging.size < 3:
        return None
    expected = slow_frequency_exact(release.plant, release.speed)
    return mean_turn(swinging, math.pi if expected is None else expected * turn) / turn


def _end(holds: NDArray[np.bool_]) -> int:
    """Return where a condition first fails."""
    return holds.size if holds.all() else int(np.argmin(holds))
