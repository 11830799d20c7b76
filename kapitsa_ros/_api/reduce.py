"""`reduce`: the critical speed from a table of readings."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros._api.inputs import as_assumptions, as_plant, as_readings, as_timings
from kapitsa_ros._api.result import describe, figures, interval_text, speed_text
from kapitsa_ros.analysis.critical_speed import (
    Ruler,
    errors_in_variables,
    fit_timings,
    uncertainty_budget,
)
from kapitsa_ros.analysis.errors import NothingTimedError
from kapitsa_ros.analysis.line_fit import fit_inverse_ols, fit_ols
from kapitsa_ros.analysis.line_fit import slope_ratio as ratio_to_theory
from kapitsa_ros.analysis.ruler import RULER_SIGMA
from kapitsa_ros.data_frame import data_frame
from kapitsa_ros.message import Message
from kapitsa_ros.physics.theory.averaged import omega_crit_averaged
from kapitsa_ros.quantities import to_si
from kapitsa_ros.reporting.allowances import allowed
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from kapitsa_ros._api.inputs import AnyAssumptions, AnyPlant, AnyReadings
    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.analysis.critical_speed import Budget, Evidence
    from kapitsa_ros.analysis.line_fit import LineFit
    from kapitsa_ros.analysis.table import Readings
    from kapitsa_ros.quantities import AnyQuantity


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Reduction:
    """The critical speed by the exact curve and by three lines; speeds in rad/s, None where there is no value."""

    readings: Readings
    evidence: Evidence
    """What the estimates rest on."""
    ruler: Ruler
    gravity: float
    omega_crit: float
    """By the exact curve: the best estimate."""
    omega_crit_interval: tuple[float | None, float | None]
    """95 % interval of `omega_crit`; an end that is None is unbounded."""
    discrepancy: float | None
    """Relative error of the periods beyond the stated ones that the curve needs; None where none reconciles them."""
    play_probability: float
    """That the pivot has play, by these readings."""
    heavy_damping_probability: float
    """That damping is not light, by these readings."""
    effective_rods: float
    """How many rods of its sample the interval rests on."""
    assumptions: Assumptions
    """What was taken for granted."""
    predicted: float
    """By averaged theory (report, eq. 8)."""
    ols: float | None = None
    """By least squares, Ω² on ω²."""
    inverse_ols: float | None = None
    """By least squares, ω² on Ω²: the fit of the report."""
    eiv: float | None = None
    """With errors in both readings."""
    eiv_interval: tuple[float | None, float | None] = (None, None)
    """95 % interval of `eiv`; an end that is None is unbounded."""
    eiv_discrepancy: float | None = 0.0
    """Relative error of the periods beyond the stated ones that was allowed for; None where none reconciles them."""
    slope_ratio: float | None = None
    """Slope of the line over that of averaged theory."""
    line: LineFit | None = None
    """The line of `inverse_ols`; None where all readings are at one speed."""
    of_table: tuple[str, ...] = ()
    """What in the table was not read, or taken for a mistake."""

    @property
    def error_percent(self) -> float | None:
        """Of `inverse_ols` against `predicted`."""
        return None if self.inverse_ols is None else 100.0 * (self.inverse_ols / self.predicted - 1.0)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is wrong with the readings."""
        return (
            *self.of_table,
            *_finding(_FAR_FROM_LINES, self.eiv_discrepancy),
            *_finding(_FAR_FROM_CURVES, self.discrepancy),
        )

    def __repr__(self) -> str:
        return describe(
            f'Reduction of {self.readings.period.size} readings',
            exact_curve=speed_text(self.omega_crit, self.omega_crit_interval),
            its_interval=interval_text(self.omega_crit_interval),
            allowed_for=allowed(asdict(self.assumptions)),
            ols=speed_text(self.ols),
            inverse_ols=speed_text(self.inverse_ols),
            errors_in_variables=speed_text(self.eiv, self.eiv_interval),
            interval=interval_text(self.eiv_interval),
            predicted=speed_text(self.predicted),
            warnings='; '.join(self.warnings) or 'none',
        )

    def budget(self) -> Budget:
        """Work out what each input contributes to the uncertainty of `omega_crit`."""
        return uncertainty_budget(self.evidence, self.ruler, self.gravity, self.assumptions)

    def to_pandas(self) -> pd.DataFrame:
        """Return a row a line."""
        rows = {
            'exact curve': self.omega_crit,
            'ordinary': self.ols,
            'inverse': self.inverse_ols,
            'errors in variables': self.eiv,
        }
        ends = [self.omega_crit_interval, (None, None), (None, None), self.eiv_interval]
        columns: dict[str, list[float]] = {
            'omega_crit_rad_s': [_number(speed) for speed in rows.values()],
            'omega_crit_rpm': [_number(speed) / RPM for speed in rows.values()],
            'low_rad_s': [_number(low) for low, _ in ends],
            'high_rad_s': [_number(high) for _, high in ends],
        }
        return data_frame({'fit': list(rows)} | columns)

    def plot(self) -> Figure:
        """Draw the readings and the line of the report's fit."""
        figure: Figure = figures().extrapolation(self.readings, as_readings('1997'), self.line)
        return figure


def reduce(
    readings: AnyReadings = '1997',
    plant: AnyPlant = None,
    *,
    amplitude_sigma: AnyQuantity = RULER_SIGMA,
    assumptions: AnyAssumptions = None,
) -> Reduction:
    """Reduce a table of readings to the critical speed, by the exact curve and in the three ways a line can be drawn.

    Parameters
    ----------
    readings
        A table, by its name or path; or columns: `(speed, period)`, and where known their standard uncertainties.
    plant
        What theory predicts for: a `Plant`, or a preset by its name or path; the report's ideal rod where not given.
        Its amplitude is what the ruler said, for the exact curve.
    amplitude_sigma
        Standard uncertainty of the ruler's word, m.
    assumptions
        What is taken for granted: `Assumptions`, or those that are not the usual ones by their names.

    Returns
    -------
    Reduction
        With `.warnings`, `.budget()`, `.to_pandas()` and `.plot()`.

    Raises
    ------
    KapitsaError
        The table cannot be read, or its readings give no line.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> found = kr.reduce((['2240 rpm', '2640 rpm', '2780 rpm'], [1.0, 0.75, 0.68]))
    >>> found.inverse_ols == kr.reduce('1997').inverse_ols
    True

    """
    table, rod = as_timings(readings), as_plant(plant)
    ruler = Ruler(amplitude=rod.amplitude, sigma=to_si('amplitude_sigma', amplitude_sigma, 'm'))
    assumed = as_assumptions(assumptions)
    found = fit_timings(table.rows, ruler, rod.gravity, assumed)
    if found.best is None:
        raise NothingTimedError
    best, evidence = found.best, found.evidence
    timed, line = evidence.timed, None
    of_lines: dict[str, Any] = {}
    if np.ptp(timed.forcing) > 0.0:
        forward, line, weighed = fit_ols(timed), fit_inverse_ols(timed), errors_in_variables(timed)
        of_lines = {
            'ols': forward.omega_crit,
            'inverse_ols': line.omega_crit,
            'eiv': weighed.omega_crit,
            'eiv_interval': weighed.interval,
            'eiv_discrepancy': weighed.discrepancy,
            'slope_ratio': ratio_to_theory(forward, rod),
        }
    return Reduction(
        readings=timed,
        evidence=evidence,
        ruler=ruler,
        gravity=rod.gravity,
        omega_crit=best.omega_crit,
        omega_crit_interval=best.interval,
        discrepancy=best.discrepancy,
        play_probability=best.play_probability,
        heavy_damping_probability=best.heavy_damping_probability,
        effective_rods=best.effective_rods,
        assumptions=assumed,
        predicted=omega_crit_averaged(rod),
        line=line,
        of_table=(*table.warnings, *filter(None, (row.miscount for row in found.rows))),
        **of_lines,
    )


_FAR_FROM_LINES = Message('the readings lie farther from any line than their uncertainties allow')
_FAR_FROM_CURVES = Message('the readings lie farther from the exact curve of any rod than their uncertainties allow')


def _finding(finding: Message, discrepancy: float | None) -> tuple[str, ...]:
    if discrepancy == 0.0:
        return ()
    if discrepancy is None:
        return (Message('{finding}: they contradict one another, and bound nothing', finding=finding),)
    percent = 100.0 * discrepancy
    return (
        Message(
            '{finding}: {percent:.2g} % of each period is added to its uncertainty', finding=finding, percent=percent
        ),
    )


def _number(value: float | None) -> float:
    return float('nan') if value is None else value
