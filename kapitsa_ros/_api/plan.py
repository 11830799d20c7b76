"""`plan`: the cheapest protocol for an aim, and the measurement that decides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros._api.inputs import as_assumptions, as_instruments, as_plant, as_readings
from kapitsa_ros._api.result import describe, speed_text, speeds_text
from kapitsa_ros.analysis.plan import best_separation, cheapest_plan
from kapitsa_ros.analysis.plan.cheapest import FASTEST
from kapitsa_ros.data_frame import data_frame
from kapitsa_ros.quantities import to_si
from kapitsa_ros.units import RPM, counted

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import NDArray

    from kapitsa_ros._api.inputs import AnyAssumptions, AnyInstruments, AnyPlant, AnyReadings
    from kapitsa_ros.analysis.plan import Separation
    from kapitsa_ros.quantities import AnyQuantity


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class PlannedProtocol:
    """A protocol, what is expected of it, and the measurement that tells two explanations apart."""

    speeds: NDArray[np.float64]
    """ω of each run, rad/s, shape (N,)."""
    swings: int
    """Full swings a timing."""
    repeats: int
    """Timings a run."""
    expected_percent: float
    """Half the width of the 95 % interval, per cent of the critical speed."""
    seconds: float
    """Time at the bench."""
    separation: Separation

    def __repr__(self) -> str:
        return describe(
            f'PlannedProtocol: ±{self.expected_percent:.2f} % (95 %) after {self.seconds:.0f} s at the bench',
            speeds=speeds_text(self.speeds),
            timings=f'{self.repeats} of {counted(self.swings, "swing")} at each',
            decides=f'{" or ".join(self.separation.between)}: {speed_text(self.separation.speed)}, '
            f'{self.separation.sigmas:.1f} standard uncertainties apart',
        )

    def to_pandas(self) -> pd.DataFrame:
        """Return a row a run."""
        return data_frame(
            {
                'speed_rad_s': self.speeds,
                'speed_rpm': self.speeds / RPM,
                'swings': np.full(self.speeds.size, self.swings),
                'repeats': np.full(self.speeds.size, self.repeats),
            }
        )


def plan(
    plant: AnyPlant = None,
    *,
    target: float,
    release: AnyQuantity = 0.12,
    max_speed: AnyQuantity = FASTEST,
    between: tuple[str, str] = ('inertia_factor', 'large_swing'),
    readings: AnyReadings = '1997',
    instruments: AnyInstruments = '1997',
    assumptions: AnyAssumptions = None,
) -> PlannedProtocol:
    """Find the cheapest protocol whose 95 % interval is within ±target per cent of the critical speed.

    Parameters
    ----------
    plant
        A `Plant`, or a preset by its name or path; the ideal rod of the report where not given.
    target
        Half the width of the interval wanted, per cent.
    release
        Angle at which the pendulum is let go, rad.
    max_speed
        Fastest the jigsaw may turn, rad/s, or with a unit as in `'3000 rpm'`.
    between
        Two explanations of `readings` to tell apart.
    readings
        A table, by its name or path, or its columns (see `reduce`).
    instruments
        A set, by its name or path, or `Instruments`.
    assumptions
        What is taken for granted: `Assumptions`, or those that are not the usual ones by their names. A pivot that may
        have play limits what can be reached.

    Returns
    -------
    PlannedProtocol
        With `.to_pandas()`.

    Raises
    ------
    KapitsaError
        An input cannot be used, or no protocol tried reaches the target.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> kr.plan(target=3.0).expected_percent <= 3.0
    True

    """
    rod = as_plant(plant)
    angle, fastest = to_si('release', release, 'rad'), to_si('max_speed', max_speed, 'rad/s')
    found = cheapest_plan(
        rod,
        as_instruments(instruments),
        target,
        release=angle,
        fastest=fastest,
        assumptions=as_assumptions(assumptions),
    )
    return PlannedProtocol(
        speeds=np.array(found.speeds),
        swings=found.swings,
        repeats=found.repeats,
        expected_percent=found.expected_percent,
        seconds=found.seconds,
        separation=best_separation(as_readings(readings), rod, *between),
    )
