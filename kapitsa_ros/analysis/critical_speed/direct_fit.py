"""The exact curve of the slow frequency fitted to what was read, and the threshold that follows from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.assumptions import DEFAULT_ASSUMPTIONS, Assumptions
from kapitsa_ros.analysis.critical_speed.errors_in_variables import RISE_95
from kapitsa_ros.analysis.critical_speed.excess_scatter import excess_scatter, improbable, rise_95
from kapitsa_ros.analysis.critical_speed.levenberg_marquardt import Minimum, minimise
from kapitsa_ros.analysis.critical_speed.likelihood import Likelihood
from kapitsa_ros.analysis.critical_speed.posterior import Posterior, posterior
from kapitsa_ros.analysis.errors import NothingTimedError
from kapitsa_ros.physics.plant import G_STANDARD
from kapitsa_ros.physics.theory.floquet import omega_crit_exact

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.analysis.evidence import Evidence
    from kapitsa_ros.analysis.ruler import Ruler

_MOST_PASSES = 10  # with the correction at the fit of the pass before
_SETTLED = 1e-2  # standard uncertainties that the last pass may move the threshold: what is left is a 1000th of that
_NO_ROD = 1e8  # standard uncertainties
_HALVINGS = 16
_MIDDLE_90 = 1.6449  # standard uncertainties of a normal distribution


@dataclass(frozen=True, kw_only=True)
class CriticalSpeed:
    """The direct fit's answer, SI units."""

    omega_crit: float
    """rad/s, exact threshold of the best-fitting plant."""
    interval: tuple[float | None, float | None]
    """95 %, rad/s, play and damping that do not show allowed for; an end is None where it is unbounded."""
    amplitude: float
    """λ, m, the ruler's word included."""
    k: float
    """m·l_c/I, 1/m, wherever the mass may sit in the rod."""
    chi_squared: float
    """At the best fit with the errors stated, the ruler's and the bounds' share included."""
    play_probability: float
    """That the pivot has play, by these readings."""
    heavy_damping_probability: float
    """That damping is not light, by these readings."""
    effective_rods: float
    """How many rods of the sample the interval rests on."""
    discrepancy: float | None = 0.0
    """Relative error of the periods beyond the stated ones, by which the runs agree; None where none makes them."""


class CurveFit:
    """The best rod without play, with light damping, and all that is possible besides.

    k is free: a ruler does not see where the rod's mass sits, and its length enters nowhere else. λ has the ruler's
    normal prior, c a half-normal one; friction is what stopped swings tell of it. Periods are those of a swing that
    narrows while it is timed. Errors of the speed count by their effect on the period (effective variance).

    Where χ² is improbably large, something is at work that the curve does not know, and the stated errors alone would
    give an interval too narrow. Then `reconcile` gives all periods a further relative error, just large enough for χ²
    to be what it should (see `excess_scatter`), and the interval Student's quantile, as that error is known from few
    runs. Runs that no such error reconciles contradict one another: their interval is unbounded.

    Raises
    ------
    NothingTimedError
        No run was timed.

    """

    def __init__(self, evidence: Evidence, ruler: Ruler, gravity: float, assumptions: Assumptions) -> None:
        if not evidence.timed.period.size:
            raise NothingTimedError
        self._ruler = ruler
        self._assumptions = assumptions
        self.amplitude_sigma = ruler.amplitude * math.hypot(
            ruler.sigma / ruler.amplitude, assumptions.stopwatch_rate_u, assumptions.dial_u
        )
        """Of the amplitude as swings show it, the errors of stopwatch and dial included, m."""
        self._likelihood = Likelihood(evidence, gravity)
        self._freedom = max(evidence.timed.period.size - 1, 1)
        self._coulomb = 0.0
        self._first: Posterior | None = None
        if evidence.stops:
            guess = self._likelihood.first_guess(ruler.amplitude)
            self._first = posterior(self._likelihood, ruler, assumptions, guess)
            self._coulomb = self._first.coulomb
        found = self._fitted()
        self.chi_squared = found.chi_squared
        """At the best fit with the errors stated."""
        self.discrepancy: float | None = 0.0
        """Relative error of the periods beyond the stated ones; None where none makes the runs agree."""
        self._best: NDArray[np.float64] = found.parameters
        self._sigma = _sigma(found.jacobian)

    @property
    def is_improbable(self) -> bool:
        """Whether χ² is too large for the errors stated."""
        return improbable(self.chi_squared, self._freedom)

    def reconcile(self) -> None:
        """Give all periods the further error that they need, where χ² is improbable."""
        if not self.is_improbable:
            return

        def with_discrepancy(error: float) -> float:
            self._likelihood.discrepancy = error
            return self._fitted().chi_squared

        self.discrepancy = excess_scatter(with_discrepancy, self._freedom)
        self._likelihood.discrepancy = self.discrepancy or 0.0
        found = self._fitted()
        self._best, self._sigma = found.parameters, _sigma(found.jacobian)

    @property
    def likelihood(self) -> Likelihood:
        """Of rods like the best one."""
        return self._likelihood

    @property
    def best(self) -> NDArray[np.float64]:
        """Averaged threshold, rad/s, amplitude, m, and damping, 1/s."""
        return self._best

    def posterior(self, like: Posterior | None = None) -> Posterior:
        """Weigh what else is possible; another posterior that this one may be much like makes it faster."""
        return posterior(self._likelihood, self._ruler, self._assumptions, float(self._best[0]), self._first or like)

    def answer(self, possible: Posterior) -> CriticalSpeed:
        """Return the best fit with the interval of a posterior."""
        threshold, amplitude, damping = self._best.tolist()
        plant = self._likelihood.plant(threshold, amplitude, 0.0)
        dial = (amplitude - self._ruler.amplitude) / self.amplitude_sigma**2 * self._ruler.amplitude
        exact = math.hypot(omega_crit_exact(plant), damping) * (1.0 + dial * self._assumptions.dial_u**2)
        return CriticalSpeed(
            omega_crit=exact,
            interval=(None, None) if self.discrepancy is None else self._interval(possible, exact),
            amplitude=amplitude,
            k=plant.k,
            chi_squared=self.chi_squared,
            play_probability=possible.play_probability,
            heavy_damping_probability=possible.heavy_damping_probability,
            effective_rods=possible.effective,
            discrepancy=self.discrepancy,
        )

    def _interval(self, possible: Posterior, exact: float) -> tuple[float, float]:
        """Return the middle 95 % of what is possible, which at least holds the middle 90 % of the best rod's own.

        Exact readings leave nothing open but causes that are all of one sign, and the rod without any is at their end.
        """
        low, middle, high = (possible.quantile(share) for share in (0.025, 0.5, 0.975))
        below, above = (exact * self._own_end(direction) / float(self._best[0]) for direction in (-1, 1))
        wider = math.sqrt(rise_95(self._freedom) / RISE_95) if self.discrepancy else 1.0
        return min(middle - wider * (middle - low), below), max(middle + wider * (high - middle), above)

    def _own_end(self, direction: int) -> float:
        """Return an end of the best rod's middle 90 %, short of what falls and stands exclude, rad/s."""
        threshold, amplitude, damping = self._best
        others = np.array([amplitude]), np.array([damping])
        known = float(self._likelihood.bounds(np.array([threshold]), *others).sum())
        away = direction * _MIDDLE_90 * self._sigma
        for _ in range(_HALVINGS):
            if known - self._likelihood.bounds(np.array([threshold + away]), *others).sum() <= 0.5 * _MIDDLE_90**2:
                return float(threshold + away)
            away *= 0.5
        return float(threshold)

    def _fitted(self) -> Minimum:
        # With no correction, or that of the fit before.
        best = self._minimum(self._first_guess()).parameters
        for _ in range(_MOST_PASSES):
            self._likelihood.correct(*best[:2])
            found = self._minimum(best)
            moved, best = abs(found.parameters[0] - best[0]), found.parameters
            if moved < _SETTLED * _sigma(found.jacobian):
                break
        return found

    def _first_guess(self) -> NDArray[np.float64]:
        return np.array([self._likelihood.first_guess(self._ruler.amplitude), self._ruler.amplitude, 0.0])

    def _residuals(self, sets: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return them for timings, falls and stands, the ruler and the damping, of M sets of parameters, shape (M, 3).

        Where no rod can have such parameters they are so large that a fit which strays there takes its step back. To
        damping below 0 they go on smoothly: a fit that would end there is through in few steps.
        """
        threshold, amplitude, damping = np.ascontiguousarray(sets.T)
        can_be = self._likelihood.can_be(threshold, amplitude)
        all_can_be = bool(can_be.all())
        if not all_can_be:
            sets = np.where(can_be[:, None], sets, self._first_guess())
            threshold, amplitude, damping = np.ascontiguousarray(sets.T)
        coulomb = np.full(damping.size, self._coulomb)
        of_readings = self._likelihood.residuals(threshold, amplitude, damping, coulomb)
        found = np.empty((damping.size, of_readings.shape[1] + 2))
        found[:, :-2] = of_readings
        found[:, -2] = (amplitude - self._ruler.amplitude) / self.amplitude_sigma
        found[:, -1] = damping / self._assumptions.light_damping
        return found if all_can_be else np.where(can_be[:, None], found, _NO_ROD)

    def _minimum(self, start: NDArray[np.float64]) -> Minimum:
        """Minimise the sum of squares; the last parameter, the damping, may be 0 and not less.

        Levenberg and Marquardt's method, once within and once at the end of the damping's range, is good to the last
        digits where readings are so exact that amplitude and damping are all but degenerate: bounded methods stop
        short.
        """
        of_two = minimise(lambda sets: self._residuals(_undamped(sets)), start[:-1])
        at_end = Minimum(
            parameters=np.append(of_two.parameters, 0.0),
            residuals=of_two.residuals,
            jacobian=_undamped(of_two.jacobian),
        )
        light = self._assumptions.light_damping
        damping = max(start[-1], 0.01 * light) if start[-1] else 0.5 * light  # it sets the scale, too
        within = minimise(self._residuals, np.append(start[:-1], damping))
        return within if within.parameters[-1] >= 0.0 and within.chi_squared < at_end.chi_squared else at_end


def direct_fit(
    evidence: Evidence, ruler: Ruler, gravity: float = G_STANDARD, assumptions: Assumptions = DEFAULT_ASSUMPTIONS
) -> CriticalSpeed:
    """Fit the exact Floquet curve Ω(ω; k, λ, c) to periods, falls and what a ruler says of λ (see `CurveFit`).

    Raises
    ------
    NothingTimedError
        No run was timed.

    """
    fit = CurveFit(evidence, ruler, gravity, assumptions)
    fit.reconcile()
    return fit.answer(fit.posterior())


def _sigma(jacobian: NDArray[np.float64]) -> float:
    """Return the standard uncertainty of the threshold by the curvature at the minimum."""
    scale = np.abs(jacobian).max(axis=0) + np.finfo(np.float64).tiny
    jacobian = jacobian / scale
    return float(np.sqrt(np.linalg.pinv(jacobian.T @ jacobian)[0, 0]) / scale[0])


def _undamped(columns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Append a column of zeros: the damping, or the derivative by it."""
    return np.column_stack((columns, np.zeros(columns.shape[0])))
