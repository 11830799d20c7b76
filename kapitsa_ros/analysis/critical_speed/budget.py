"""The uncertainty budget of the critical speed, as the GUM has it (JCGM 100), held against Monte Carlo (JCGM 101)."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from itertools import combinations
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from scipy.special import stdtrit

from kapitsa_ros.analysis.assumptions import DEFAULT_ASSUMPTIONS, Assumptions
from kapitsa_ros.analysis.critical_speed.direct_fit import CurveFit
from kapitsa_ros.analysis.critical_speed.measurement_function import Inputs, MeasurementFunction
from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.physics.plant import G_STANDARD
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from kapitsa_ros.analysis.critical_speed.posterior import Posterior
    from kapitsa_ros.analysis.evidence import Evidence
    from kapitsa_ros.analysis.ruler import Ruler

    Array = NDArray[np.float64]

DRAWS = 20_000
"""Of the Monte Carlo evaluation: its standard uncertainty is good to 0.5 %."""
LINEAR = 0.05
"""Relative difference of u_c from Monte Carlo's up to which the model counts as linear."""
_EFFECTS = {'play': ('play D', 'm'), 'damping': ('damping c', '1/s'), 'coulomb': ('Coulomb friction f', 'rad/s²')}
"""Name and unit of what the sample of rods tells, by the field."""
_NAMES = [name for name, _ in _EFFECTS.values()]


@dataclass(frozen=True, kw_only=True)
class BudgetRow:
    """One input quantity, SI units."""

    name: str
    value: float
    unit: str
    u: float
    """Standard uncertainty."""
    kind: str
    """Type of evaluation: A or B."""
    distribution: str
    sensitivity: float
    """∂ω_crit/∂input, rad/s per unit of the input, over ± its standard uncertainty (GUM 5.1.3)."""
    freedom: float = math.inf
    """Degrees of freedom."""

    @property
    def contribution(self) -> float:
        """To the standard uncertainty of the critical speed, rad/s."""
        return abs(self.sensitivity) * self.u


@dataclass(frozen=True, kw_only=True)
class Budget:
    """What the critical speed's uncertainty is made of; speeds in rad/s."""

    rows: tuple[BudgetRow, ...]
    correlations: tuple[tuple[str, str, float], ...]
    """Of two inputs, where there is one."""
    value: float
    """At the inputs' expectations, play and friction included: not the best estimate, which is for a rod without."""
    u: float
    """Combined standard uncertainty u_c, by the law of propagation."""
    freedom: float
    """Effective degrees of freedom, by Welch and Satterthwaite (GUM G.4)."""
    draws: int
    """Of Monte Carlo."""
    monte_carlo_value: float
    """Mean of the draws."""
    monte_carlo_u: float
    """Standard deviation of the draws."""
    monte_carlo_interval: tuple[float, float]
    """Middle 95 % of the draws."""

    @property
    def k(self) -> float:
        """Coverage factor for 95 %: Student's quantile for the effective degrees of freedom."""
        return float(stdtrit(min(self.freedom, 1e9), 0.975))

    @property
    def expanded(self) -> float:
        """Expanded uncertainty U = k u_c, rad/s."""
        return self.k * self.u

    @property
    def is_linear(self) -> bool:
        """Whether u_c is Monte Carlo's within 5 %; where not, Monte Carlo's holds."""
        return abs(self.u / self.monte_carlo_u - 1.0) <= LINEAR


def uncertainty_budget(
    evidence: Evidence, ruler: Ruler, gravity: float = G_STANDARD, assumptions: Assumptions = DEFAULT_ASSUMPTIONS
) -> Budget:
    """Work out what each input contributes to the uncertainty of the critical speed.

    Readings, ruler and instruments enter with what is stated of them; play, damping and friction with what their priors
    and the readings leave of them, together, as they are correlated.

    Raises
    ------
    NothingTimedError
        No run was timed.
    AnalysisError
        The runs contradict one another.

    """
    fit = CurveFit(evidence, ruler, gravity, assumptions)
    fit.reconcile()
    if fit.discrepancy is None:
        raise AnalysisError('the runs contradict one another: they bound nothing, and a budget would say that they do')
    possible = fit.posterior()
    function = MeasurementFunction(fit)
    base = _expected(evidence, ruler, possible)
    inputs = _rows(evidence, ruler, assumptions, possible, fit.discrepancy)
    rows = tuple(replace(row, sensitivity=_sensitivity(function, base, row, put)) for row, put in inputs)
    correlations = _correlations(possible)
    by_name = {row.name: row.sensitivity * row.u for row in rows}
    variance = sum(row.contribution**2 for row in rows)
    variance += 2.0 * sum(r * by_name[one] * by_name[other] for one, other, r in correlations)
    u = math.sqrt(max(variance, 0.0))
    scatter = sum(row.contribution**4 / row.freedom for row in rows)
    drawn = function(_drawn(base, inputs, possible))
    low, high = np.quantile(drawn, (0.025, 0.975)).tolist()
    return Budget(
        rows=rows,
        correlations=tuple(correlations),
        value=float(function(base)[0]),
        u=u,
        freedom=u**4 / scatter if scatter else math.inf,
        draws=DRAWS,
        monte_carlo_value=float(drawn.mean()),
        monte_carlo_u=float(drawn.std(ddof=1)),
        monte_carlo_interval=(low, high),
    )


_Put: TypeAlias = 'Callable[[Inputs, Array], Inputs]'


def _expected(evidence: Evidence, ruler: Ruler, possible: Posterior) -> Inputs:
    timed = evidence.timed
    mean = {name: np.array([possible.mean(getattr(possible.rods, name))]) for name in _EFFECTS}
    return Inputs(
        period=timed.period[None, :],
        forcing=timed.forcing[None, :],
        amplitude=np.array([ruler.amplitude]),
        stopwatch_rate=np.zeros(1),
        dial=np.zeros(1),
        of_periods=np.zeros((1, timed.period.size)),
        **mean,
    )


def _rows(
    evidence: Evidence, ruler: Ruler, assumptions: Assumptions, possible: Posterior, scatter: float
) -> list[tuple[BudgetRow, _Put]]:
    """Return each input, its sensitivity not yet known, and how values are put in its place."""
    timed = evidence.timed
    rows: list[tuple[BudgetRow, _Put]] = []
    for index in range(timed.period.size):
        period, forcing = float(timed.period[index]), float(timed.forcing[index])
        of_period, of_speed = float(timed.period_sigma[index]), float(timed.forcing_sigma[index])
        at = f'at {forcing / RPM:.0f} RPM'
        rows += [
            (_type_b(f'period T {at}', period, 's', of_period), _in_column('period', index)),
            (_type_b(f'speed ω {at}', forcing, 'rad/s', of_speed), _in_column('forcing', index)),
        ]
    rows.append((_type_b('amplitude λ by the ruler', ruler.amplitude, 'm', ruler.sigma), _in_field('amplitude')))
    for field, (name, unit) in _EFFECTS.items():
        values = getattr(possible.rods, field)
        mean = possible.mean(values)
        u = math.sqrt(possible.mean((values - mean) ** 2))
        row = replace(_type_b(name, mean, unit, u), distribution='prior and readings')
        rows.append((row, _in_field(field)))
    rate, dial = assumptions.stopwatch_rate_u, assumptions.dial_u
    rows.append((_type_b('rate of the stopwatch', 0.0, '', rate), _in_field('stopwatch_rate')))
    rows.append((_type_b('calibration of the dial', 0.0, '', dial), _in_field('dial')))
    freedom = max(timed.period.size - 1, 1)
    for index in range(timed.period.size):
        name = f'scatter beyond the stated errors at {timed.forcing[index] / RPM:.0f} RPM'
        row = replace(_type_b(name, 0.0, '', scatter), kind='A', freedom=freedom)
        rows.append((row, _in_column('of_periods', index)))
    return [(row, put) for row, put in rows if row.u > 0.0]


def _type_b(name: str, value: float, unit: str, u: float) -> BudgetRow:
    return BudgetRow(name=name, value=value, unit=unit, u=u, kind='B', distribution='normal', sensitivity=math.nan)


def _in_field(name: str) -> _Put:
    return lambda inputs, values: replace(inputs, **{name: values})


def _in_column(name: str, index: int) -> _Put:
    def put(inputs: Inputs, values: Array) -> Inputs:
        column = getattr(inputs, name).copy()
        column[:, index] = values
        return replace(inputs, **{name: column})

    return put


def _repeated(inputs: Inputs, times: int) -> Inputs:
    return Inputs(**{item.name: np.repeat(getattr(inputs, item.name), times, axis=0) for item in fields(inputs)})


def _sensitivity(function: MeasurementFunction, base: Inputs, row: BudgetRow, put: _Put) -> float:
    """Return half the change from one standard uncertainty below to one above, but not below what an input can be."""
    low = row.value - row.u
    if row.name in _NAMES:
        low = max(low, 0.0)
    high = row.value + row.u
    below, above = function(put(_repeated(base, 2), np.array([low, high]))).tolist()
    return float((above - below) / (high - low))


def _correlations(possible: Posterior) -> list[tuple[str, str, float]]:
    found = []
    for (one, (name, _)), (other, (other_name, _)) in combinations(_EFFECTS.items(), 2):
        values = np.stack([getattr(possible.rods, field) for field in (one, other)])
        covariance = np.cov(values, aweights=possible.rod_weight)
        scale = math.sqrt(covariance[0, 0] * covariance[1, 1])
        if scale > 0.0:
            found.append((name, other_name, float(covariance[0, 1]) / scale))
    return found


def _drawn(base: Inputs, rows: list[tuple[BudgetRow, _Put]], possible: Posterior) -> Inputs:
    """Draw inputs, each normally but play, damping and friction, which come together from the sample of rods."""
    generator = np.random.Generator(np.random.PCG64(1))
    inputs = _repeated(base, DRAWS)
    for row, put in rows:
        if row.name not in _NAMES:
            inputs = put(inputs, row.value + row.u * generator.standard_normal(DRAWS))
    chosen = generator.choice(possible.rod_weight.size, DRAWS, p=possible.rod_weight)
    return replace(inputs, **{name: getattr(possible.rods, name)[chosen] for name in _EFFECTS})
