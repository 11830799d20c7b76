"""A rod that bends: one assumed mode, pinned at the pivot and free at the tip (the report saw flexing, § 4).

A point at s along the rod lies at s e_r + φ(s) η e_θ. With the moving pivot's Lagrangian and the mode's mass scaled to
the rod's, the equations are (per mass; J = l_c/k)

    d/dt[(J + η²) θ′] = (g + y″)(l_c sin θ + β η cos θ) − J c θ′
    η″ = η θ′² + β (g + y″) sin θ − ω_b² η − 2ζ ω_b η′,    β = ∫φ ds / L.

For ω_b → ∞ they are the rigid rod's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
import scipy

from kapitsa_ros.physics.errors import ParameterError, PhysicsError
from kapitsa_ros.physics.kernels.flexible import WORK_SHAPE, advance_flexible
from kapitsa_ros.physics.release import PROMISED, REFINEMENTS, STOP
from kapitsa_ros.physics.step_size import LONGEST_STEP, longest_step, whole_samples

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.physics.release import Release


@dataclass(frozen=True, kw_only=True)
class BendingMode:
    """The rod's first bending mode.

    Raises
    ------
    ParameterError
        A value is not finite or out of its range.

    """

    frequency: float
    """ω_b, rad/s."""
    damping: float = 0.0
    """ζ, of critical."""

    def __post_init__(self) -> None:
        if not 0 < self.frequency < math.inf:
            raise ParameterError(f'bending frequency is {self.frequency} rad/s: give a finite one above 0')
        if not 0 <= self.damping < math.inf:
            raise ParameterError(f'bending damping is {self.damping}: it must not be negative')


@dataclass(frozen=True, kw_only=True, eq=False)
class FlexibleTrajectory:
    """What a bending rod did, at equidistant times from the release on; shape (N,) each."""

    time: NDArray[np.float64]
    angle: NDArray[np.float64]
    """θ of the rod's undeformed line, rad."""
    rate: NDArray[np.float64]
    deflection: NDArray[np.float64]
    """η, m: the root mean square over the rod of its deflection."""
    deflection_rate: NDArray[np.float64]
    fell: bool


@cache
def coupling() -> float:
    """Return β of a uniform rod: the mean of its first pinned-free mode, scaled to a mean square of 1.

    φ = sin λx/sin λ + sinh λx/sinh λ with tan λ = tanh λ; λ = 3.9266 (Blevins, Formulas for Natural Frequency and Mode
    Shape, table 8-1).
    """
    root = float(scipy.optimize.brentq(lambda x: math.tan(x) - math.tanh(x), 3.8, 4.0, xtol=1e-15))
    # The modes' mean square is 1 as they stand: φ(1)²/4.
    trigonometric = (1.0 - math.cos(root)) / math.sin(root)
    return (trigonometric + (math.cosh(root) - 1.0) / math.sinh(root)) / root


def simulate_flexible(
    release: Release, bending: BendingMode, duration: float, sample_rate: float = 1000.0
) -> FlexibleTrajectory:
    """Integrate a bending rod, straight and at rest at time 0.

    Parameters
    ----------
    release
        Its plant may have viscous damping, but neither Coulomb friction nor play.
    bending
        The mode.
    duration
        s.
    sample_rate
        Hz.

    Raises
    ------
    ParameterError
        The duration holds no sample period; the plant has friction or play; the run is linear.
    PhysicsError
        The promised accuracy cannot be kept.

    """
    plant = release.plant
    if not plant.linearly_damped or release.linear:
        raise ParameterError(
            'a bending rod has neither coulomb friction nor clearance and is not linear: '
            'set those to 0, or leave the bending out'
        )
    count = whole_samples(duration, sample_rate)
    quickest = bending.frequency * max(1.0, 2.0 * bending.damping)
    longest = min(longest_step(plant, release.speed), LONGEST_STEP / quickest)
    stride = math.ceil(1.0 / (sample_rate * longest))
    lever = 0.5 * plant.length
    rod = np.array(
        [lever / plant.k, lever, coupling(), plant.gravity, plant.damping, bending.frequency, bending.damping],
    )
    start = (release.phase / (2.0 * math.pi)) % 1.0
    work = np.empty(WORK_SHAPE)
    for refinement in REFINEMENTS:
        motion = np.zeros((4, count + 1))
        motion[0, 0] = release.angle
        steps = stride * refinement
        step = 1.0 / (sample_rate * steps)
        truncation = advance_flexible(plant.amplitude, release.speed, start, step, steps, STOP, rod, motion, work)
        if truncation <= PROMISED:
            return _trajectory(sample_rate, motion)
    raise PhysicsError(f'a step leaves out {truncation:.1g} rad: the rod swings too wildly for 1e-8 rad')


def _trajectory(sample_rate: float, motion: NDArray[np.float64]) -> FlexibleTrajectory:
    return FlexibleTrajectory(
        time=np.arange(motion.shape[1]) / sample_rate,
        angle=motion[0],
        rate=motion[1],
        deflection=motion[2],
        deflection_rate=motion[3],
        fell=bool(abs(motion[0, -1]) >= STOP),
    )
