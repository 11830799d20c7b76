"""One run without the graph: the rod released at rest on a pivot that moves as a pure cosine."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from kapitsa_ros.physics.errors import ParameterError, PhysicsError
from kapitsa_ros.physics.kernels import layout
from kapitsa_ros.physics.kernels.cosine import TOO_MANY_EVENTS, WORK_SHAPE, advance_cosine
from kapitsa_ros.physics.limits import MOST_TURNS, check_forcing
from kapitsa_ros.physics.step_size import longest_step, steps_per_turn, whole_samples

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.physics.plant import Plant

STOP = math.pi / 2
PROMISED = 1e-11  # rad left out of one step at most
REFINEMENTS = (1, 2, 4, 8)


class _Leg(NamedTuple):
    """Equidistant samples at one pace."""

    start: float
    """Phase of the pivot, turns."""
    period: float
    """From sample to sample, s."""
    turns: float
    """Of the shaft in that time."""
    stride: int
    """Steps from sample to sample."""
    samples: int


@dataclass(frozen=True, kw_only=True, eq=False)
class Trajectory:
    """What the rod did, at equidistant times from the release on."""

    time: NDArray[np.float64]
    """s, shape (N,)."""
    angle: NDArray[np.float64]
    """θ, rad, shape (N,)."""
    rate: NDArray[np.float64]
    """θ′, rad/s, shape (N,)."""
    fell: bool
    """It lies at the stop, or has come off its pivot."""
    stuck: bool
    """Friction held it when the run ended."""
    clearance: float
    """D at the end, m."""


@dataclass(frozen=True, kw_only=True)
class Release:
    """A rod let go at rest at time 0.

    Raises
    ------
    ParameterError
        A value is not finite or out of its range.

    """

    plant: Plant
    speed: float
    """ω, rad/s."""
    angle: float
    """θ, rad, short of the horizontal."""
    phase: float = 0.0
    """p of the pivot, rad: 0 is the bottom of the stroke."""
    linear: bool = False
    """Take θ for sin θ (report, eq. 2)."""

    def __post_init__(self) -> None:
        check_forcing(self.speed)
        if not abs(self.angle) < STOP:
            raise ParameterError(f'release angle is {self.angle} rad: it must lie within ±π/2')
        if not math.isfinite(self.phase):
            raise ParameterError(f'phase is {self.phase}: give a finite number')

    def sampled(self, duration: float, sample_rate: float = 1000.0) -> Trajectory:
        """Integrate over a duration (s) and sample it, the start included.

        Raises
        ------
        ParameterError
            The duration holds no sample period.
        PhysicsError
            The promised accuracy cannot be kept, or impacts are too close together.

        """
        count = whole_samples(duration, sample_rate)
        stride = math.ceil(1.0 / (sample_rate * longest_step(self.plant, self.speed)))
        turns = self.speed / (2.0 * math.pi * sample_rate)
        motion, state = self._follow([_Leg(self._start, 1.0 / sample_rate, turns, stride, count)])
        return _trajectory(np.arange(count + 1) / sample_rate, motion, state)

    def strobed(self, turns: int) -> Trajectory:
        """Integrate over a number of turns of the shaft and look at each bottom of the stroke, exactly in phase."""
        period = 2.0 * math.pi / self.speed
        stride = steps_per_turn(self.plant, self.speed)
        lead = (1.0 - self._start) % 1.0
        legs = [_Leg(0.0, period, 1.0, stride, turns)]
        if lead > 0:
            legs.insert(0, _Leg(self._start, lead * period, lead, stride, 1))
        motion, state = self._follow(legs)
        return _trajectory((lead + np.arange(turns + 1)) * period, motion, state)

    @property
    def _start(self) -> float:
        """Turns from the bottom at time 0."""
        return (self.phase / (2.0 * math.pi)) % 1.0

    def _follow(self, legs: list[_Leg]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the motion over the last leg and the state it ends in; a wild swing takes shorter steps."""
        turns = sum(leg.turns * leg.samples for leg in legs)
        if turns > MOST_TURNS:
            raise ParameterError(
                f'the shaft turns {turns:.2g} times, at most {MOST_TURNS:g} can be followed: reduce duration or speed'
            )
        constants = layout.constants(self.plant, stop=STOP, linear=self.linear)
        work = np.empty(WORK_SHAPE)
        for refinement in REFINEMENTS:
            state = layout.state_at_rest(self.angle, self.plant.clearance)
            state[layout.MODE] = layout.MOVING
            worst = 0.0
            for leg in legs:
                stride = leg.stride * refinement
                motion = np.empty((2, leg.samples + 1))
                pacing = (leg.period / stride, leg.turns / stride, stride)
                truncation = advance_cosine(
                    self.plant.amplitude, self.speed, leg.start, *pacing, constants, state, motion, work
                )
                if truncation == TOO_MANY_EVENTS:
                    raise PhysicsError('impacts at the pivot are too close together to be resolved: reduce restitution')
                worst = max(worst, truncation)
            if worst <= PROMISED:
                return motion, state
        raise PhysicsError(f'a step leaves out {worst:.1g} rad: the rod swings too wildly for 1e-8 rad')


def _trajectory(
    time: NDArray[np.floating],
    motion: NDArray[np.float64],
    state: NDArray[np.float64],
) -> Trajectory:
    return Trajectory(
        time=np.asarray(time, dtype=float),
        angle=motion[0],
        rate=motion[1],
        fell=bool(state[layout.MODE] >= layout.FALLEN),
        stuck=bool(state[layout.MODE] == layout.STUCK),
        clearance=float(state[layout.CLEARANCE]),
    )
