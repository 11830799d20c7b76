"""`reduce`: the critical speed from a table of readings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kapitsa_ros._api.inputs import as_plant, as_readings
from kapitsa_ros._api.result import describe, figures, interval_text, speed_text
from kapitsa_ros.analysis.critical_speed import errors_in_variables
from kapitsa_ros.analysis.line_fit import fit_inverse_ols, fit_ols
from kapitsa_ros.analysis.line_fit import slope_ratio as ratio_to_theory
from kapitsa_ros.data_frame import data_frame
from kapitsa_ros.physics.theory.averaged import omega_crit_averaged
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from kapitsa_ros._api.inputs import AnyPlant, AnyReadings
    from kapitsa_ros.analysis.line_fit import LineFit
    from kapitsa_ros.analysis.table import Readings


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Reduction:
    """The critical speed by three lines; speeds in rad/s, None where there is no value."""

    readings: Readings
    ols: float | None
    """By least squares, Ω² on ω²."""
    inverse_ols: float | None
    """By least squares, ω² on Ω²: the fit of the report."""
    eiv: float | None
    """With errors in both readings."""
    eiv_interval: tuple[float | None, float | None]
    """95 % interval of `eiv`; an end that is None is unbounded."""
    eiv_discrepancy: float | None
    """Relative error of the periods beyond the stated ones that was allowed for; None where none reconciles them."""
    slope_ratio: float
    """Slope of the line over that of averaged theory."""
    predicted: float
    """By averaged theory (report, eq. 8)."""
    line: LineFit
    """The line of `inverse_ols`."""

    @property
    def error_percent(self) -> float | None:
        """Of `inverse_ols` against `predicted`."""
        return None if self.inverse_ols is None else 100.0 * (self.inverse_ols / self.predicted - 1.0)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is wrong with the readings."""
        if self.eiv_discrepancy == 0.0:
            return ()
        finding = 'the readings lie farther from any line than their errors allow'
        if self.eiv_discrepancy is None:
            return (f'{finding}: they contradict one another, and bound nothing',)
        return (f'{finding}: {100.0 * self.eiv_discrepancy:.2g} % of each period is added to its error',)

    def __repr__(self) -> str:
        return describe(
            f'Reduction of {self.readings.period.size} readings',
            ols=speed_text(self.ols),
            inverse_ols=speed_text(self.inverse_ols),
            errors_in_variables=speed_text(self.eiv),
            interval=interval_text(self.eiv_interval),
            predicted=speed_text(self.predicted),
            warnings='; '.join(self.warnings) or 'none',
        )

    def to_pandas(self) -> pd.DataFrame:
        """Return a row a line."""
        rows = {'ordinary': self.ols, 'inverse': self.inverse_ols, 'errors in variables': self.eiv}
        ends = [(None, None), (None, None), self.eiv_interval]
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


def reduce(readings: AnyReadings = '1997', plant: AnyPlant = None) -> Reduction:
    """Reduce a table of readings to the critical speed, in the three ways a line can be drawn.

    Parameters
    ----------
    readings
        A table, by its name or path; or columns: `(speed, period)`, and where known the standard errors of either.
    plant
        What theory predicts for: a `Plant`, or a preset by its name or path; the report's ideal rod where not given.

    Returns
    -------
    Reduction
        With `.warnings`, `.to_pandas()` and `.plot()`.

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
    table, rod = as_readings(readings), as_plant(plant)
    forward, backward, weighed = fit_ols(table), fit_inverse_ols(table), errors_in_variables(table)
    return Reduction(
        readings=table,
        ols=forward.omega_crit,
        inverse_ols=backward.omega_crit,
        eiv=weighed.omega_crit,
        eiv_interval=weighed.interval,
        eiv_discrepancy=weighed.discrepancy,
        slope_ratio=ratio_to_theory(forward, rod),
        predicted=omega_crit_averaged(rod),
        line=backward,
    )


def _number(value: float | None) -> float:
    return float('nan') if value is None else value
