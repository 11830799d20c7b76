"""The question the report left open: whether the slow divergence of the frictionless pendulum is real.

The same pendulum is integrated with the solvers people use, as they come, and the growth of its slow amplitude is read
once a turn of the shaft. Where solvers disagree about the sign, the divergence is theirs.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import solve_ivp

from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.kernels.verlet import verlet
from kapitsa_ros.physics.theory.floquet_amplitude import mean_growth, slow_amplitude, smooth_mean

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from kapitsa_ros.physics.release import Release

    Orbit = NDArray[np.floating]

VERLET_STEPS = 100
AROUND = 250  # turns, a dozen slow periods: what an amplitude is the mean of
MOST_TURNS = 10_000_000  # of which memory holds the orbits
SWINGING = 1.0  # rad: beyond, the rod is falling over
SOLVERS: tuple[tuple[str, dict[str, float]], ...] = (
    ('RK45', {}),
    ('RK23', {}),
    ('BDF', {}),
    ('LSODA', {}),
    ('Radau', {}),
    ('DOP853', {'rtol': 1e-12, 'atol': 1e-14}),
)


@dataclass(frozen=True, kw_only=True)
class SolverResult:
    """What one solver makes of the pendulum."""

    solver: str
    duration: float
    """Simulated time it was followed for, s."""
    growth: float
    """Of the slow amplitude, 1/s, while it swings."""
    amplitude_ratio: float
    """The slow amplitude at the end (or where it falls over) over the first."""
    fell_at: float | None
    """s; None if it never did."""
    cpu: float
    """s."""


def compare_solvers(release: Release, *, duration: float = 300.0, cycles: int = 1_000_000) -> Iterator[SolverResult]:
    """Follow a frictionless pendulum with each solver for a duration (s), and with ours for many cycles too.

    Raises
    ------
    PhysicsError
        The plant has friction or play, which would hide what the solvers do; or there are more than `MOST_TURNS`.

    """
    plant = release.plant
    if not plant.conservative:
        raise PhysicsError('the study asks about a frictionless pendulum: leave out damping, coulomb and clearance')
    asked = duration * release.speed / (2.0 * math.pi)
    if not max(asked, cycles) <= MOST_TURNS:
        raise PhysicsError(
            f'{asked:.4g} turns of the shaft for each solver and {cycles} for ours: at most {MOST_TURNS}, reduce '
            f'{"duration" if asked > MOST_TURNS else "cycles"}'
        )
    turns = math.floor(asked) - 1
    for method, options in SOLVERS:
        name = f'{method} (rtol {options["rtol"]:g})' if options else f'{method} (as it comes)'
        yield _watch(name, release, lambda m=method, o=options: _scipy(release, m, o, turns))  # type: ignore[misc]
    yield _watch(f'Verlet ({VERLET_STEPS} steps a turn)', release, lambda: _verlet(release, turns))
    yield _watch('ours', release, lambda: _ours(release, turns))
    yield _watch(f'ours, {cycles} cycles', release, lambda: _ours(release, cycles))


def _watch(name: str, release: Release, work: Callable[[], Orbit]) -> SolverResult:
    start = time.process_time()
    angle, rate = work()
    cpu = time.process_time() - start
    turn = 2.0 * math.pi / release.speed
    fallen = np.flatnonzero(np.abs(angle) >= SWINGING)
    end = int(fallen[0]) if fallen.size else angle.size
    amplitude = slow_amplitude(release.plant, release.speed, angle[:end], rate[:end])
    around = min(AROUND, amplitude.size)
    return SolverResult(
        solver=name,
        duration=(angle.size - 1) * turn,
        growth=mean_growth(amplitude) / turn,
        amplitude_ratio=smooth_mean(np.abs(amplitude[-around:])) / smooth_mean(np.abs(amplitude[:around])),
        fell_at=end * turn if fallen.size else None,
        cpu=cpu,
    )


def _ours(release: Release, turns: int) -> Orbit:
    orbit = release.strobed(turns)
    return np.stack((orbit.angle, orbit.rate))


def _verlet(release: Release, turns: int) -> Orbit:
    plant = release.plant
    weight, shake = plant.k * plant.gravity, plant.k * plant.amplitude * release.speed**2
    orbit = np.empty((2, turns + 1))
    verlet(weight, shake, release.speed, release.phase, release.angle, VERLET_STEPS, orbit)
    return orbit


def _scipy(release: Release, method: str, options: dict[str, float], turns: int) -> Orbit:
    plant, speed, phase = release.plant, release.speed, release.phase
    weight, shake = plant.k * plant.gravity, plant.k * plant.amplitude * speed**2

    def slope(t: float, y: NDArray[np.floating]) -> tuple[float, float]:
        return y[1], (weight + shake * math.cos(speed * t + phase)) * math.sin(y[0])

    bottoms = (np.arange(turns + 1) + (-phase / (2.0 * math.pi)) % 1.0) * (2.0 * math.pi / speed)
    start = (release.angle, 0.0)
    solution = solve_ivp(slope, (0.0, bottoms[-1]), start, method=method, t_eval=bottoms, **options)
    return np.asarray(solution.y)
