"""How well a plant explains the evidence: the residuals whose squares add up to −2 ln of the likelihood."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import exprel, log_ndtr

from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.theory.averaged import k_of_slow_frequency, period_steepness, plant_of_threshold
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.analysis.critical_speed.evidence import Bound, Evidence
    from kapitsa_ros.analysis.critical_speed.ruler import Ruler
    from kapitsa_ros.physics.plant import Plant

DAMPING_SIGMA = 0.5
"""1/s; of c: a swing that can be timed has lost no more than half its width in some seconds."""

FLOOR = 1e-5
"""Relative error below which no reading is trusted."""
_NO_ROD = 1e8  # standard errors
_NO_SWING = 1e-3  # rad/s, stands for no slow frequency at all


class Likelihood:
    """Residuals as a function of the averaged threshold √(2g/k)/λ, the amplitude λ and the damping c.

    Damping hardly changes the frequency; it narrows the swing while it is timed, and a narrow swing is a faster one.
    """

    def __init__(self, evidence: Evidence, ruler: Ruler, gravity: float) -> None:
        self._evidence = evidence
        self.ruler = ruler
        """What is known of λ."""
        self.discrepancy = 0.0
        """Relative error of the model's periods, to be added to the stated errors."""
        self._gravity = gravity
        self._slowing = np.zeros_like(evidence.timed.period)

    def plant(self, threshold: float, amplitude: float, damping: float) -> Plant:
        """Return the plant of these parameters."""
        return plant_of_threshold(threshold, amplitude, self._gravity, damping)

    def first_guess(self) -> float:
        """Solve Ω² = k²λ²ω²/2 − kg for k, run by run, with the ruler's λ; return the middle threshold."""
        timed, amplitude = self._evidence.timed, self.ruler.amplitude
        k = k_of_slow_frequency(timed.forcing, timed.slow, amplitude, self._gravity)
        return float(np.median(np.sqrt(2.0 * self._gravity / k) / amplitude))

    def correct_for_width(self, threshold: float, amplitude: float) -> None:
        """Find by how much the swing as released is slower than a small one."""
        plant = self.plant(threshold, amplitude, 0.0)
        runs = zip(self._evidence.timed.forcing.tolist(), self._evidence.release.tolist(), strict=True)
        for index, (speed, release) in enumerate(runs):
            try:
                wide = slow_frequency_nonlinear(plant, speed, release)
            except PhysicsError:
                continue  # this plant falls, or nobody let go: the swing is left as it is
            self._slowing[index] = 1.0 - wide / _frequency(plant, speed)

    def residuals(self, threshold: float, amplitude: float, damping: float) -> NDArray[np.float64]:
        """Return them for the timed runs, the falls and stands, the ruler and the damping.

        Where no rod can have such parameters they are so large that a fit which strays there takes its step back.
        """
        timed = self._evidence.timed
        try:
            plant = self.plant(threshold, amplitude, damping)
        except PhysicsError:
            return np.full(timed.period.size + len(self._evidence.fell) + len(self._evidence.stood) + 2, _NO_ROD)
        small = np.array([_frequency(plant, float(speed)) for speed in timed.forcing])
        slow = small * (1.0 - self._slowing * self._wane(damping))
        steepness = period_steepness(plant, timed.forcing, timed.slow)
        floor = FLOOR**2 + self.discrepancy**2
        sigma = timed.period * np.sqrt(
            (timed.period_sigma / timed.period) ** 2 + (steepness * timed.forcing_sigma) ** 2 + floor
        )
        exact = threshold * (1.0 + 7.0 / 128.0 * (2.0 * plant.k * amplitude) ** 2)  # the next term of a₀(q), DLMF 28.6
        return np.concatenate(
            (
                (timed.period - 2.0 * math.pi / slow) / sigma,
                self._bounds(exact),
                ((amplitude - self.ruler.amplitude) / self.ruler.sigma, damping / DAMPING_SIGMA),
            )
        )

    def _wane(self, damping: float) -> NDArray[np.float64]:
        """Return the mean of A²/A₀² between the first press, ¾ of a period after the release, and the last."""
        first = damping * 0.75 * self._evidence.timed.period
        timed = damping * self._evidence.swings * self._evidence.timed.period
        return np.asarray(np.exp(-first) * exprel(-timed))

    def _bounds(self, threshold: float) -> list[float]:
        """Weigh falls and stands; a wide release falls a little above the threshold, out of the effective well."""
        fell = [
            _one_sided_residual(threshold / math.sqrt(math.cos(bound.release)) - bound.speed, bound)
            for bound in self._evidence.fell
        ]
        return fell + [_one_sided_residual(bound.speed - threshold, bound) for bound in self._evidence.stood]


def _one_sided_residual(margin: float, bound: Bound) -> float:
    return math.sqrt(-2.0 * float(log_ndtr(margin / max(bound.sigma, FLOOR * bound.speed))))


def _frequency(plant: Plant, speed: float) -> float:
    try:
        return slow_frequency_exact(plant, speed) or _NO_SWING
    except PhysicsError:  # so far below the threshold that no swing can be meant
        return _NO_SWING
