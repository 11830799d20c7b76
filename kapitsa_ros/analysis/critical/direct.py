"""The exact curve of the slow frequency fitted to what was read, and the threshold that follows from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from iminuit import Minuit  # type: ignore[import-untyped]
from scipy.optimize import brentq
from scipy.special import log_ndtr

from kapitsa_ros.analysis.critical.errors_in_variables import RISE_95
from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.parameters import PlantParameters
from kapitsa_ros.physics.theory.floquet import omega_crit_exact, slow_frequency_exact
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.analysis.critical.evidence import Evidence, Ruler

_FLOOR = 1e-6  # relative error below which no reading is trusted
_PASSES = 3  # of the swing's width, whose effect hangs weakly on the fit
_DAMPING_SIGMA = 0.2  # 1/s: a swing that can be timed at all has lost little in a few periods
_REACH = 12  # times that the search for an end triples its distance
_NO_SWING = 1e-3  # rad/s, stands for no slow frequency at all


@dataclass(frozen=True, kw_only=True)
class CriticalSpeed:
    """The direct fit's answer, SI units."""

    omega_crit: float
    """rad/s, exact threshold of the best-fitting plant."""
    interval: tuple[float | None, float | None]
    """95 % by profile likelihood, rad/s; an end is None where it is unbounded."""
    amplitude: float
    """λ, m, the ruler's word included."""
    k: float
    """m·l_c/I, 1/m, wherever the mass may sit in the rod."""
    chi_squared: float
    """At the best fit, the ruler's and the bounds' share included."""


def direct_fit(evidence: Evidence, ruler: Ruler, gravity: float = 9.80665) -> CriticalSpeed:
    """Fit the exact Floquet curve Ω(ω; k, λ, c) to periods, falls and what a ruler says of λ.

    k is free: a ruler does not see where the rod's mass sits, and its length enters nowhere else. λ has the ruler's
    normal prior, c a half-normal one. Periods are corrected for the width of the swing by the nonlinear map at the
    commanded release. Errors of the speed count by their effect on the period (effective variance). The interval is
    by profile likelihood in the averaged threshold √(2g/k)/λ, which the exact one follows to 1e-4 whatever λ.

    Raises
    ------
    AnalysisError
        No run was timed, or the fit does not converge: the runs contradict one another.

    """
    if not evidence.timed.period.size:
        raise AnalysisError('no swing was timed in any run: time one, or read the bounds off the runs that fell')
    cost = _Cost(evidence, ruler, gravity)
    start = (cost.first_guess(), ruler.amplitude, 0.0)
    for _ in range(_PASSES):
        cost.correct_for_width(*start)
        fit = Minuit(cost, *start, name=('threshold', 'amplitude', 'damping_squared'))
        fit.errordef = Minuit.LEAST_SQUARES
        fit.limits['threshold'] = (0.0, None)
        fit.limits['amplitude'] = (0.0, None)
        fit.limits['damping_squared'] = (0.0, None)
        fit.errors = (1e-3 * start[0], ruler.sigma, 0.1 * _DAMPING_SIGMA**2)
        fit.tol = 1e-3
        fit.migrad()
        start = tuple(fit.values)
    if not math.isfinite(fit.fval or math.nan):
        raise AnalysisError('no curve fits the readings: the runs contradict one another')
    plant = cost.plant(*fit.values)
    exact = omega_crit_exact(plant)
    scale, lowest = exact / fit.values['threshold'], float(fit.fval)
    ends = _interval(fit)
    return CriticalSpeed(
        omega_crit=exact,
        interval=(None if ends[0] is None else scale * ends[0], None if ends[1] is None else scale * ends[1]),
        amplitude=plant.amplitude,
        k=plant.k,
        chi_squared=lowest,
    )


def _interval(fit: Minuit) -> tuple[float | None, float | None]:
    """Return the ends of the 95 % interval of the threshold: where the profile has risen by `RISE_95`.

    MINOS proper loses its way where the damping lies at its end; the profile itself does not.
    """
    best, lowest, values = float(fit.values['threshold']), float(fit.fval), tuple(fit.values)
    step = max(float(fit.errors['threshold']), 1e-9 * best)
    fit.fixed['threshold'] = True

    def excess(threshold: float) -> float:
        fit.values = (threshold, *values[1:])
        fit.migrad()
        return float(fit.fval) - lowest - RISE_95

    def end(direction: int) -> float | None:
        inner, outer = best, best + 2.0 * direction * step
        for _ in range(_REACH):
            if outer <= 0.0:
                return None
            if excess(outer) > 0.0:
                return float(brentq(excess, inner, outer, xtol=1e-3 * step))
            inner, outer = outer, outer + 2.0 * (outer - best)
        return None

    return end(-1), end(1)


class _Cost:
    """−2 ln of the likelihood, as a function of the averaged threshold, the amplitude and the damping squared.

    It is the square of the damping that enters Ω², so the fit is nearly linear in it up to its end at 0.
    """

    def __init__(self, evidence: Evidence, ruler: Ruler, gravity: float) -> None:
        self._evidence = evidence
        self._ruler = ruler
        self._gravity = gravity
        self._width = np.ones_like(evidence.timed.period)

    def plant(self, threshold: float, amplitude: float, damping_squared: float) -> PlantParameters:
        """Return the plant of these parameters; its length is nominal, the inertia factor makes up for it."""
        k = 2.0 * self._gravity / (amplitude * threshold) ** 2
        return PlantParameters(
            length=1.5,
            amplitude=amplitude,
            gravity=self._gravity,
            damping=math.sqrt(damping_squared),
            inertia_factor=k,
        )

    def first_guess(self) -> float:
        """Solve Ω² = k²λ²ω²/2 − kg for k, run by run, with the ruler's λ; return the middle threshold."""
        timed, amplitude = self._evidence.timed, self._ruler.amplitude
        stroke = (amplitude * timed.forcing) ** 2
        k = (self._gravity + np.sqrt(self._gravity**2 + 2.0 * stroke * timed.slow**2)) / stroke
        return float(np.median(np.sqrt(2.0 * self._gravity / k) / amplitude))

    def correct_for_width(self, threshold: float, amplitude: float, damping_squared: float) -> None:
        """Find by how much the released swing is slower than a small one."""
        plant = self.plant(threshold, amplitude, damping_squared)
        for index, speed in enumerate(self._evidence.timed.forcing):
            small = slow_frequency_exact(plant, float(speed))
            if small and 0.0 < self._evidence.release < math.pi / 2:
                try:
                    wide = slow_frequency_nonlinear(plant, float(speed), self._evidence.release)
                except PhysicsError:
                    continue  # this plant would have fallen: the next pass has a better one
                undamped = slow_frequency_exact(self.plant(threshold, amplitude, 0.0), float(speed))
                self._width[index] = wide / (undamped or small)

    def __call__(self, threshold: float, amplitude: float, damping_squared: float) -> float:
        """Return −2 ln L."""
        if not (threshold > 0.0 and amplitude > 0.0):
            return math.inf
        timed = self._evidence.timed
        plant = self.plant(threshold, amplitude, max(damping_squared, 0.0))
        slow = self._slow(plant)
        period = 2.0 * math.pi / slow
        moved = (plant.k * plant.amplitude) ** 2 * timed.forcing / (2.0 * timed.slow**2) * timed.forcing_sigma
        variance = timed.period_sigma**2 + (timed.period * moved) ** 2 + (_FLOOR * timed.period) ** 2
        misfit = float(np.sum((timed.period - period) ** 2 / variance))
        prior = ((amplitude - self._ruler.amplitude) / self._ruler.sigma) ** 2 + damping_squared / _DAMPING_SIGMA**2
        return misfit + prior + self._bounds(threshold * (1.0 + 7.0 / 128.0 * (2.0 * plant.k * amplitude) ** 2))

    def _slow(self, plant: PlantParameters) -> NDArray[np.float64]:
        return np.array([_frequency(plant, float(speed)) for speed in self._evidence.timed.forcing]) * self._width

    def _bounds(self, threshold: float) -> float:
        """Weigh falls and stands; a wide release falls a little above the threshold, out of the effective well."""
        fallen = threshold / math.sqrt(math.cos(self._evidence.release))
        odds = [_log_odds(fallen - speed, sigma, speed) for speed, sigma in self._evidence.fell]
        odds += [_log_odds(speed - threshold, sigma, speed) for speed, sigma in self._evidence.stood]
        return -2.0 * sum(odds)


def _frequency(plant: PlantParameters, speed: float) -> float:
    try:
        return slow_frequency_exact(plant, speed) or _NO_SWING
    except PhysicsError:  # so far below the threshold that no swing can be meant
        return _NO_SWING


def _log_odds(margin: float, sigma: float, speed: float) -> float:
    return float(log_ndtr(margin / max(sigma, _FLOOR * speed)))
