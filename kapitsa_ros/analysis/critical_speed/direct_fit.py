"""The exact curve of the slow frequency fitted to what was read, and the threshold that follows from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import OptimizeResult, brentq, least_squares

from kapitsa_ros.analysis.critical_speed.errors_in_variables import RISE_95
from kapitsa_ros.analysis.critical_speed.excess_scatter import excess_scatter, improbable, rise_95
from kapitsa_ros.analysis.critical_speed.likelihood import DAMPING_SIGMA, Likelihood
from kapitsa_ros.analysis.errors import NothingTimedError
from kapitsa_ros.physics.plant import G_STANDARD
from kapitsa_ros.physics.theory.floquet import omega_crit_exact

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from kapitsa_ros.analysis.critical_speed.evidence import Evidence
    from kapitsa_ros.analysis.critical_speed.ruler import Ruler

_MOST_PASSES = 10  # of the swing's width, whose effect hangs weakly on the fit
_SETTLED = 1e-3  # standard errors that the last pass may move the threshold
_REACH = 12  # times that the search for an end triples its distance


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
    """At the best fit with the errors stated, the ruler's and the bounds' share included."""
    discrepancy: float | None = 0.0
    """Relative error of the periods beyond the stated ones, by which the runs agree; None where none makes them."""


def direct_fit(evidence: Evidence, ruler: Ruler, gravity: float = G_STANDARD) -> CriticalSpeed:
    """Fit the exact Floquet curve Ω(ω; k, λ, c) to periods, falls and what a ruler says of λ.

    k is free: a ruler does not see where the rod's mass sits, and its length enters nowhere else. λ has the ruler's
    normal prior, c a half-normal one. Periods are corrected for the width of the swing by the nonlinear map at the
    commanded release; the width wanes with c, which stands for all friction there. Errors of the speed count by their
    effect on the period (effective variance). The interval is by profile likelihood in the averaged threshold, which
    the exact one follows to 1e-4 whatever λ.

    Where χ² is improbably large, friction or play that the curve does not know is at work, and the stated errors alone
    would give an interval too narrow. Then all periods get a further relative error, just large enough for χ² to be
    what it should (see `excess_scatter`), and the interval Student's quantile, as that error is known from few runs.
    Runs that no such error reconciles contradict one another: their interval is unbounded.

    Raises
    ------
    NothingTimedError
        No run was timed.

    """
    if not evidence.timed.period.size:
        raise NothingTimedError('no swing was timed in any run: time one')
    likelihood = Likelihood(evidence, ruler, gravity)
    found = _fitted(likelihood)
    stated = 2.0 * float(found.cost)
    freedom = max(evidence.timed.period.size - 1, 1)
    dark: float | None = 0.0
    rise = RISE_95
    if improbable(stated, freedom):

        def with_dark_error(error: float) -> float:
            likelihood.discrepancy = error
            return 2.0 * float(_fitted(likelihood).cost)

        dark, rise = excess_scatter(with_dark_error, freedom), rise_95(freedom)
        likelihood.discrepancy = dark or 0.0
        found = _fitted(likelihood)
    best = found.x
    plant = likelihood.plant(*best)
    exact = math.hypot(omega_crit_exact(likelihood.plant(best[0], best[1], 0.0)), best[2])  # damping: next order
    lower, upper = (None, None) if dark is None else _interval(likelihood, found, rise)
    return CriticalSpeed(
        omega_crit=exact,
        interval=(lower and float(lower * exact / best[0]), upper and float(upper * exact / best[0])),
        amplitude=plant.amplitude,
        k=plant.k,
        chi_squared=stated,
        discrepancy=dark,
    )


def _fitted(likelihood: Likelihood) -> OptimizeResult:
    best = np.array([likelihood.first_guess(), likelihood.ruler.amplitude, 0.0])
    for _ in range(_MOST_PASSES):
        likelihood.correct_for_width(*best[:2])
        found = _minimise(likelihood.residuals, best)
        moved, best = abs(found.x[0] - best[0]), found.x
        if moved < _SETTLED * _sigma(found):
            break
    return found


def _minimise(residuals: Callable[..., NDArray[np.float64]], start: NDArray[np.float64]) -> OptimizeResult:
    """Minimise the sum of squares; the last parameter, the damping, may be 0 and not less.

    Levenberg and Marquardt's method, once within and once at the end of the damping's range, is good to the last
    digits where readings are so exact that amplitude and damping are all but degenerate: bounded methods stop short.
    """
    at_end = _levenberg_marquardt(lambda *others: residuals(*others, 0.0), start[:-1])
    at_end.x = np.append(at_end.x, 0.0)
    at_end.jac = np.column_stack((at_end.jac, np.zeros(at_end.fun.size)))
    within = _levenberg_marquardt(residuals, np.append(start[:-1], start[-1] or 0.5 * DAMPING_SIGMA))
    return within if within.x[-1] >= 0.0 and within.cost < at_end.cost else at_end


def _levenberg_marquardt(residuals: Callable[..., NDArray[np.float64]], start: NDArray[np.float64]) -> OptimizeResult:
    scale = np.where(start > 0.0, 1e-3 * start, DAMPING_SIGMA)
    return least_squares(
        lambda parameters: residuals(*parameters), start, x_scale=scale, method='lm', xtol=1e-13, ftol=1e-13, gtol=1e-13
    )


def _sigma(found: OptimizeResult) -> float:
    """Return the standard error of the threshold by the curvature at the minimum."""
    scale = np.abs(found.jac).max(axis=0) + np.finfo(np.float64).tiny
    jacobian = found.jac / scale
    return float(np.sqrt(np.linalg.pinv(jacobian.T @ jacobian)[0, 0]) / scale[0])


def _interval(likelihood: Likelihood, found: OptimizeResult, rise: float) -> tuple[float | None, float | None]:
    """Return where the profile of the threshold has risen by `rise`, on either side."""
    best, others = float(found.x[0]), found.x[1:]
    step = _sigma(found)

    def excess(threshold: float) -> float:
        profiled = _minimise(lambda *rest: likelihood.residuals(threshold, *rest), others)
        return 2.0 * float(profiled.cost - found.cost) - rise

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
