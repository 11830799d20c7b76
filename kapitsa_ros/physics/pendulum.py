"""The pendulum as the network sees it: pivot motion in, angle out, a block at a time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.errors import MotionError, ParameterError, PhysicsError
from kapitsa_ros.physics.kernels import layout, sampled
from kapitsa_ros.physics.kernels.hermite import STENCIL, stencil_weights
from kapitsa_ros.physics.sampled_motion import SampledMotion

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant


class Pendulum:
    """A rod on a shaken pivot, held at upright at first; a copy moves on by itself.

    θ″ = k (g + y″) sin θ − c θ′ − f sgn θ′ (report, eqs. 1, 17 and 19), with play and wear at the pivot where the
    plant has them.

    Parameters
    ----------
    plant
        What it is made of.
    stop
        |θ| at which the rod has fallen over and lies, rad.
    linear
        Take θ for sin θ (report, eq. 2).

    Raises
    ------
    ParameterError
        The stop is not an angle above 0.

    """

    def __init__(self, plant: Plant, *, stop: float = math.pi / 2, linear: bool = False) -> None:
        if not 0 < stop < math.inf:
            raise ParameterError(f'stop is {stop} rad: give a finite angle above 0')
        self._stop = stop
        self._constants = layout.constants(plant, stop=stop, linear=linear)
        self._state = layout.state_at_rest(0.0, plant.clearance)

    @property
    def angle(self) -> float:
        """θ from upright, rad."""
        return float(self._state[layout.ANGLE])

    @property
    def rate(self) -> float:
        """θ′, rad/s."""
        return float(self._state[layout.RATE])

    @property
    def held(self) -> bool:
        """The catch holds the rod (it may be waiting for the bottom of the stroke)."""
        return bool(self._state[layout.MODE] == layout.HELD)

    @property
    def stuck(self) -> bool:
        """Friction holds the rod."""
        return bool(self._state[layout.MODE] == layout.STUCK)

    @property
    def fell(self) -> bool:
        """The rod lies at the stop, or has come off its worn pivot."""
        return bool(self._state[layout.MODE] >= layout.FALLEN)

    @property
    def failed(self) -> bool:
        """The hole has worn through."""
        return bool(self._state[layout.MODE] == layout.FAILED)

    @property
    def clearance(self) -> float:
        """D with the wear so far, m."""
        return float(self._state[layout.CLEARANCE])

    @property
    def impact_energy(self) -> float:
        """Energy that impacts have taken so far, J/kg of the relative motion."""
        return float(self._state[layout.IMPACT_ENERGY])

    def hold(self, angle: float) -> None:
        """Put the rod at an angle and hold it there; wear stays.

        Raises
        ------
        ParameterError
            The angle is not short of the stop.
        PhysicsError
            The hole has worn through.

        """
        if not abs(angle) < self._stop:
            raise ParameterError(f'angle is {angle} rad: it must lie within the stop (±{self._stop:.4g} rad)')
        if self.failed:
            raise PhysicsError('the pivot hole has worn through: begin with a new pendulum')
        energy = self.impact_energy
        self._state = layout.state_at_rest(angle, self.clearance)
        self._state[layout.IMPACT_ENERGY] = energy

    def release(self) -> None:
        """Let go at the first bottom of the stroke from the next sample on, or at once if the pivot rests."""
        if self.held:
            self._state = self._state.copy()
            self._state[layout.RELEASING] = 1.0

    def advance(self, pivot: SampledMotion) -> SampledMotion:
        """Carry the rod through one block of pivot motion.

        Returns
        -------
        SampledMotion
            θ, θ′ and θ″ at the same times.

        Raises
        ------
        MotionError
            The samples lie too far apart for the motion between them, the pivot's or the rod's.
        PhysicsError
            Impacts or reversals are too close together to be resolved.

        """
        count = pivot.position.size
        state = self._state.copy()
        motion = np.empty((3, count))
        weights = stencil_weights(min(STENCIL, count))
        outcome = sampled.advance_block(
            weights,
            pivot.period,
            np.stack((pivot.position, pivot.rate, pivot.acceleration)),
            self._constants,
            state,
            motion,
            np.empty((count - 1, weights.shape[1])),
            np.empty(sampled.WORK_SHAPE),
        )
        if outcome == sampled.TOO_COARSE:
            raise MotionError(
                f'pivot samples {pivot.period:.3g} s apart are too coarse for its motion: sample it more often',
            )
        if outcome == sampled.TOO_MANY_EVENTS:
            raise PhysicsError(
                'impacts or reversals at the pivot are too close together to be resolved: reduce restitution'
            )
        if outcome == sampled.TOO_FAST:
            raise MotionError(
                f'pivot samples {pivot.period:.3g} s apart are too coarse for so quick a rod: sample it more often',
            )
        self._state = state
        return SampledMotion(period=pivot.period, position=motion[0], rate=motion[1], acceleration=motion[2])
