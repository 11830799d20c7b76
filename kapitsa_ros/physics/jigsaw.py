"""The jigsaw: a shaft that keeps its phase, and the crank that turns it into a stroke."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.errors import MotionError
from kapitsa_ros.physics.jigsaw_parameters import JigsawParameters
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.sampled_motion import SampledMotion

if TYPE_CHECKING:
    from numpy.typing import NDArray

TWO_PI = Fraction('6.283185307179586476925286766559005768394338798750')
TURN = 1 << 128
_DEFAULTS = JigsawParameters()


class Jigsaw:
    """A shaft that runs up to the requested speed and drives the pivot through a crank.

    The speed is linear in time within a step, so the pivot's motion has kinks only where steps meet. The phase is kept
    as a whole number of 2⁻¹²⁸ turns, so it loses nothing however long the shaft runs.

    Parameters
    ----------
    amplitude
        λ, m: the crank's radius.
    parameters
        Of crank and shaft.

    Raises
    ------
    ParameterError
        A value is not finite or out of its range.

    """

    def __init__(
        self,
        *,
        amplitude: float,
        parameters: JigsawParameters = _DEFAULTS,
    ) -> None:
        self._amplitude = Plant(amplitude=amplitude).amplitude
        self._rod_ratio = parameters.rod_ratio
        self._spin_up = parameters.spin_up
        self._max_speed = parameters.max_speed
        self._turn = round(Fraction(parameters.phase) / TWO_PI * TURN) % TURN
        self._speed = 0.0

    @property
    def speed(self) -> float:
        """φ′ now, rad/s."""
        return self._speed

    @property
    def phi(self) -> float:
        """φ now, rad in [0, 2π): 0 is the bottom of the stroke."""
        return 2.0 * math.pi * (self._turn / TURN)

    def advance(self, target_speed: float, duration: float, count: int) -> SampledMotion:
        """Run for one step, towards a speed that is reached, if at all, just when the step ends.

        Parameters
        ----------
        target_speed
            rad/s, in [0, max_speed].
        duration
            Of the step, seconds.
        count
            Intervals between samples, 1 or more.

        Returns
        -------
        SampledMotion
            The pivot's y, y′ and y″ at count + 1 times.

        Raises
        ------
        MotionError
            A speed the jigsaw cannot do, or a step that is none.

        """
        if not 0 <= target_speed <= self._max_speed:
            raise MotionError(f'speed is {target_speed} rad/s: the jigsaw does 0 to {self._max_speed:.6g} rad/s')
        if not 0 < duration < math.inf or count < 1:
            raise MotionError(f'a step of {duration} s in {count} intervals: give a positive duration and count')
        reach = self._spin_up * duration
        final = min(max(target_speed, self._speed - reach), self._speed + reach)
        angular_acceleration = (final - self._speed) / duration
        time = _sample_times(duration, count)
        phi = self.phi + time * (self._speed + 0.5 * angular_acceleration * time)
        samples = self._stroke(phi, self._speed + angular_acceleration * time, angular_acceleration, duration / count)

        self._turn = (self._turn + _turns(self._speed, final, duration)) % TURN
        self._speed = final
        return samples

    def _stroke(
        self,
        phi: NDArray[np.float64],
        speed: NDArray[np.float64],
        angular_acceleration: float,
        period: float,
    ) -> SampledMotion:
        """Return the pivot's motion: y(φ) and the chain rule."""
        height, slope, curvature = crank(phi, self._rod_ratio)
        return SampledMotion(
            period=period,
            position=self._amplitude * height,
            rate=self._amplitude * slope * speed,
            acceleration=self._amplitude * (curvature * speed**2 + slope * angular_acceleration),
        )


@lru_cache(maxsize=16)
def _sample_times(duration: float, count: int) -> NDArray[np.float64]:
    """Return the times of a step's samples from its begin, s."""
    times = np.linspace(0.0, duration, count + 1)
    times.flags.writeable = False
    return times


@lru_cache(maxsize=16)
def _turns(first: float, final: float, duration: float) -> int:
    """Return the 2⁻¹²⁸ turns that a shaft makes while its speed goes from one value to another; mostly it is steady."""
    travel = (Fraction(first) + Fraction(final)) / 2 * Fraction(duration)
    return round(travel / TWO_PI * TURN)


def crank(
    phi: NDArray[np.float64],
    rod_ratio: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the pivot's height over the crank's radius, and its first two derivatives by φ.

    The pivot stands above the crank, as on a jigsaw held upside down: y/λ = −cos φ + √(ρ² − sin² φ) − ρ with the rod
    ratio ρ, and −cos φ for ρ = 0. It runs from −1 (φ = 0) to 1 (φ = π).
    """
    sine, cosine = np.sin(phi), np.cos(phi)
    if rod_ratio == 0:
        return -cosine, sine, cosine
    rod = np.sqrt(rod_ratio**2 - sine**2)
    tilt = sine * cosine / rod
    height = -cosine - sine**2 / (rod + rod_ratio)
    return height, sine - tilt, cosine - (cosine**2 - sine**2) / rod - tilt**2 / rod
