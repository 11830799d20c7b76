"""`theory`: what theory says of a rod, at any number of speeds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros._api.inputs import as_plant
from kapitsa_ros._api.result import describe, figures, plant_text, speed_text, speeds_text
from kapitsa_ros.data_frame import data_frame
from kapitsa_ros.physics import theory as physics
from kapitsa_ros.physics.limits import FASTEST, check_forcing
from kapitsa_ros.quantities import to_si, to_si_array
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from kapitsa_ros._api.inputs import AnyPlant
    from kapitsa_ros.physics.plant import Plant
    from kapitsa_ros.physics.theory import TheoryResult
    from kapitsa_ros.quantities import AnyQuantities, AnyQuantity


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Theory:
    """What theory says; arrays have the shape of the speeds asked for, () for a single one."""

    plant: Plant
    speed: NDArray[np.float64]
    """ω, rad/s."""
    mathieu_q: float
    """q = 2kλ."""
    mathieu_a: NDArray[np.float64]
    """a = −4kg/ω²."""
    stable: NDArray[np.bool_]
    """Whether the upright rod stays up."""
    slow: NDArray[np.float64]
    """Ω, rad/s: exact, of small swings; nan where there is none."""
    slow_averaged: NDArray[np.float64]
    """Ω, rad/s, of the averaged equation (report, eq. 15); nan where there is none."""
    growth: NDArray[np.float64]
    """Of the slow motion, 1/s; negative where it decays."""
    omega_crit: float
    """Exact critical speed, rad/s, with the play at the pivot."""
    omega_crit_averaged: float
    """By the averaged equation, rad/s (report, eq. 8)."""
    omega_crit_upper: float | None
    """Speed from which the rod is unstable again, rad/s; None where there is none."""
    comparison: tuple[tuple[TheoryResult, ...], ...]
    """The theories compared for a swing of the given release, an entry a speed; empty where none was given."""
    warnings: tuple[str, ...]
    """Which speeds have no answer, and why."""

    def __repr__(self) -> str:
        return describe(
            f'Theory: {plant_text(self.plant)}',
            critical_speed=speed_text(self.omega_crit),
            averaged=speed_text(self.omega_crit_averaged),
            upper_limit=speed_text(self.omega_crit_upper),
            speeds=speeds_text(self.speed),
            slow=speeds_text(self.slow[np.isfinite(self.slow)]),
            warnings='; '.join(self.warnings) or 'none',
        )

    def to_pandas(self) -> pd.DataFrame:
        """Return a row a speed."""
        columns = {
            'speed_rad_s': self.speed,
            'speed_rpm': self.speed / RPM,
            'mathieu_a': self.mathieu_a,
            'stable': self.stable,
            'slow_rad_s': self.slow,
            'slow_rpm': self.slow / RPM,
            'slow_averaged_rad_s': self.slow_averaged,
            'growth_per_s': self.growth,
        }
        return data_frame({name: np.ravel(column) for name, column in columns.items()})

    def plot(self) -> Figure:
        """Draw the slow frequency over the speed."""
        figure: Figure = figures().slow_frequency(
            np.ravel(self.speed), np.ravel(self.slow), np.ravel(self.slow_averaged), self.omega_crit
        )
        return figure


def theory(plant: AnyPlant = None, *, speed: AnyQuantities = (), release: AnyQuantity | None = None) -> Theory:
    """Say what theory predicts of a rod: its critical speeds, and what it does at given ones.

    Parameters
    ----------
    plant
        A `Plant`, or a preset by its name or path; the ideal rod of the report where not given.
    speed
        ω in rad/s, or with a unit (`'2500 rpm'`, see `rpm`); one, or any number of them.
    release
        Also compare the theories for a swing let go at this θ (rad).

    Returns
    -------
    Theory
        With arrays of the shape of `speed`, `.to_pandas()` and `.plot()`.

    Raises
    ------
    KapitsaError
        An input cannot be used; a single speed has no answer. Of several speeds those without are nan, and
        `.warnings` says why.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> found = kr.theory(kr.Plant(), speed=['1200 rpm', '2500 rpm'])
    >>> found.stable
    array([False,  True])
    >>> found.slow.round(3)
    array([   nan, 12.024])

    """
    rod = as_plant(plant)
    criticals: dict[str, Any] = {
        'omega_crit_averaged': physics.omega_crit_averaged(rod),
        'omega_crit': physics.omega_crit_with_play(rod),
        'omega_crit_upper': physics.omega_crit_upper(rod),
    }
    omega = to_si_array('speed', speed, 'rad/s')
    at = _at_one(rod, float(omega)) if omega.ndim == 0 else _at_many(rod, omega)
    angle = None if release is None else to_si('release', release, 'rad')
    comparison = () if angle is None else tuple(tuple(physics.compare_theories(rod, one, angle)) for one in omega.flat)
    if rod.clearance > 0.0:
        at['warnings'] += ('the exact critical speed is with the play; all else is that of a pivot without',)
    return Theory(plant=rod, speed=omega, mathieu_q=physics.mathieu_q(rod), comparison=comparison, **criticals, **at)


def _at_one(plant: Plant, speed: float) -> dict[str, Any]:
    """Ask the functions for one speed, which raise where there is no answer."""
    check_forcing(speed)
    answers: dict[str, Any] = {
        'mathieu_a': physics.mathieu_a(plant, speed),
        'stable': physics.is_stable(plant, speed),
        'slow': physics.slow_frequency_exact(plant, speed),
        'slow_averaged': physics.slow_frequency_averaged(plant, speed),
        'growth': physics.growth_rate(plant, speed),
    }
    return {name: np.array(np.nan if value is None else value) for name, value in answers.items()} | {'warnings': ()}


def _at_many(plant: Plant, speeds: NDArray[np.float64]) -> dict[str, Any]:
    slow, growth = (curve.reshape(speeds.shape) for curve in physics.floquet_curves(plant, speeds.ravel()))
    possible = (speeds > 0) & (speeds <= FASTEST)
    with np.errstate(divide='ignore', invalid='ignore', over='ignore'):
        a = np.where(possible, physics.mathieu_a(plant, speeds), np.nan)
        averaged = np.where(possible, np.sqrt(physics.slow_squared_averaged(plant, speeds)), np.nan)
    warnings = []
    if wrong := int(np.count_nonzero(~possible)):
        warnings.append(f'{wrong} of {speeds.size} speeds are not above 0 and at most {FASTEST:g} rad/s')
    if lost := int(np.count_nonzero(possible & np.isnan(growth))):
        warnings.append(
            f'at {lost} of {speeds.size} speeds the rod falls too fast within one turn for double precision'
        )
    return {
        'mathieu_a': a,
        'stable': growth <= 0,
        'slow': slow,
        'slow_averaged': averaged,
        'growth': growth,
        'warnings': tuple(warnings),
    }
