"""How well rods explain the evidence: the logarithm of their likelihood, and the residuals that it is made of."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import log_ndtr

from kapitsa_ros.analysis.critical_speed.swing_model import SwingModel
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.kernels.slow_period import FIRST_PRESS, period_errors
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.averaged import k_of_slow_frequency, plant_of_threshold
from kapitsa_ros.physics.theory.floquet import omega_crit_exact, slow_frequency_exact
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear
from kapitsa_ros.schema import describe

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.analysis.evidence import Evidence

    Array = NDArray[np.float64]

FLOOR = 1e-5
"""Relative error below which no reading is trusted."""
_ESCAPE_DOUBT = 0.1  # of how much farther from the threshold a wide release falls
_STOP_DOUBT = 0.1  # of the number of swings that friction leaves, relative
_WIDEST = 1.5  # rad
_QUANTITIES = {item.name: item for item in describe(Plant)}


class Likelihood:
    """The likelihood of M rods at once, given as arrays of shape (M,): see `SwingModel` for what a rod is."""

    def __init__(self, evidence: Evidence, gravity: float) -> None:
        self.evidence = evidence
        self.gravity = gravity
        self.model = SwingModel(evidence, gravity)
        self.discrepancy = 0.0
        """Relative error of the model's periods, to be added to the stated errors."""
        self._threshold_correction = 1.0
        timed = evidence.timed
        self._period = np.ascontiguousarray(timed.period)
        self._period_variance = (timed.period_sigma / timed.period) ** 2 + FLOOR**2  # relative
        # −d ln T/dω is (kλ)² ω/(2Ω²)
        self._error_by_speed = timed.forcing * timed.forcing_sigma / (2.0 * timed.slow**2)

    def first_guess(self, amplitude: float) -> float:
        """Solve Ω² = k²λ²ω²/2 − kg for k, row by row, with a given λ; return the middle threshold, rad/s."""
        timed = self.evidence.timed
        k = k_of_slow_frequency(timed.forcing, timed.slow, amplitude, self.gravity)
        return float(np.median(np.sqrt(2.0 * self.gravity / k) / amplitude))

    def correct(self, threshold: float, amplitude: float) -> None:
        """Make good, for rods like this, what series and potential leave out: by Floquet's theory and the swing map."""
        plant = plant_of_threshold(threshold, amplitude, self.gravity)
        one = (np.array([threshold]), np.array([amplitude]), np.zeros(1))
        timed = self.evidence.timed
        self.model.correction = np.ones_like(timed.period)
        small = self.model.small(*one, timed.forcing)[0]
        undamped = SwingModel(self.evidence, self.gravity).periods(*one, np.zeros(1))[0][0]
        correction = np.ones_like(small)
        for index, (speed, release) in enumerate(
            zip(timed.forcing.tolist(), self.evidence.release.tolist(), strict=True)
        ):
            try:
                exact = slow_frequency_exact(plant, speed)
                wide = slow_frequency_nonlinear(plant, speed, release) if release else exact
            except PhysicsError:
                continue  # this rod falls: the swing is left as it is
            if exact and wide:
                of_width = (exact / wide) / (undamped[index] * small[index] / (2.0 * math.pi))
                correction[index] = small[index] / exact * of_width
        self.model.correction = correction
        self._threshold_correction = omega_crit_exact(plant) / float(self._series_threshold(*one)[0])

    def can_be(self, threshold: Array, amplitude: Array) -> NDArray[np.bool_]:
        """Tell of which rods `plant` can make one, shape (M,)."""
        with np.errstate(all='ignore'):
            k = self.model.k(threshold, amplitude)
        return np.asarray(_QUANTITIES['amplitude'].holds(amplitude) & _QUANTITIES['inertia_factor'].holds(k))

    def plant(self, threshold: float, amplitude: float, damping: float) -> Plant:
        """Return the plant of these parameters."""
        return plant_of_threshold(threshold, amplitude, self.gravity, damping)

    def exact_threshold(self, threshold: Array, amplitude: Array, damping: Array) -> Array:
        """Return the critical speed itself, rad/s, for the averaged one."""
        return self._threshold_correction * self._series_threshold(threshold, amplitude, damping)

    def _series_threshold(self, threshold: Array, amplitude: Array, damping: Array) -> Array:
        """Add the next term of a₀(q) (DLMF 28.6.1) and c²."""
        q = 2.0 * self.model.k(threshold, amplitude) * amplitude
        return np.hypot(threshold * (1.0 + 7.0 / 128.0 * q**2), damping)

    def sigma(self, threshold: Array, amplitude: Array, doubt: Array) -> Array:
        """Return the standard uncertainty of each period, s, shape (M, N); that of the speed counts by its effect."""
        reach = self.model.k(threshold, amplitude) * amplitude
        variance = self._period_variance + self.discrepancy**2
        sigma = np.empty(doubt.shape)
        period_errors(reach, self._error_by_speed, variance, self._period, doubt, sigma)
        return sigma

    def bounds(self, threshold: Array, amplitude: Array, damping: Array) -> Array:
        """Return ln L of each fall and of each that stood, shape (M, falls + stands).

        A wide release falls from above the threshold too, out of the effective well, whose barrier lies where
        cos θ₁ = (ω_crit/ω)².
        """
        if not (self.evidence.fell or self.evidence.stood):
            return np.zeros((threshold.size, 0))
        exact = self.exact_threshold(threshold, amplitude, damping)
        still = np.maximum(1.0 - self.model.k(threshold, amplitude) * amplitude, 0.1)  # report, eq. 12
        columns = []
        for fall in self.evidence.fell:
            highest = exact / np.sqrt(np.cos(np.minimum(fall.release / still, _WIDEST)))
            sigma = np.hypot(max(fall.sigma, FLOOR * fall.speed), _ESCAPE_DOUBT * (highest - exact))
            columns.append(log_ndtr((highest - fall.speed) / sigma))
        columns.extend(
            log_ndtr((stand.speed - exact) / max(stand.sigma, FLOOR * stand.speed)) for stand in self.evidence.stood
        )
        return np.stack(columns, axis=-1)

    def stops(self, threshold: Array, amplitude: Array, damping: Array, coulomb: Array) -> Array:
        """Return ln L of where swings stopped, and of that those that were timed did not, shape (M,).

        A swing that lasts n periods passes upright ⌊2n + ½⌋ times.
        """
        timed, stopped = self.model.swings_before_stop(threshold, amplitude, damping, coulomb)
        needed = self.evidence.swings + FIRST_PRESS
        released = self.evidence.release > 0.0
        known = _log_probability(np.where(released, timed, np.inf), needed).sum(axis=-1)
        seen = self.model.seen
        most = _log_probability(seen + 1.0 + FIRST_PRESS, np.maximum(stopped, 1e-9))
        least = np.where(seen > 0.0, _log_probability(np.maximum(stopped, 1e-9), seen + FIRST_PRESS), 0.0)
        return np.asarray(known + (most + least).sum(axis=-1))

    def residuals(self, threshold: Array, amplitude: Array, damping: Array, coulomb: Array) -> Array:
        """Return those of the periods and of the falls and stands, whose squares add up to −2 ln L, shape (M, R)."""
        period, doubt = self.model.periods(threshold, amplitude, damping, coulomb)
        timed = (self.evidence.timed.period - period) / self.sigma(threshold, amplitude, doubt)
        return np.concatenate((timed, np.sqrt(-2.0 * self.bounds(threshold, amplitude, damping))), axis=1)


def _log_probability(lasts: Array, needed: Array) -> Array:
    """Return ln of the probability that a swing lasts as long as it did."""
    return np.asarray(log_ndtr(np.log(lasts / needed) / _STOP_DOUBT))
