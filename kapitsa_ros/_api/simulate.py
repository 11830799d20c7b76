"""`simulate`: one run without the graph."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros._api.inputs import as_plant
from kapitsa_ros._api.result import describe, figures, plant_text, speed_text
from kapitsa_ros.data_frame import data_frame
from kapitsa_ros.physics.errors import ParameterError
from kapitsa_ros.physics.flexible_rod import BendingMode, FlexibleTrajectory, simulate_flexible
from kapitsa_ros.physics.release import Release, Trajectory
from kapitsa_ros.physics.run_summary import summarise_run
from kapitsa_ros.quantities import to_si

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from kapitsa_ros._api.inputs import AnyPlant
    from kapitsa_ros.quantities import AnyQuantity


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Simulation:
    """One run: what the rod did, and what its slow motion is."""

    run: Release
    """The rod and how it was let go."""
    time: NDArray[np.float64]
    """s, shape (N,)."""
    angle: NDArray[np.float64]
    """θ, rad, shape (N,)."""
    rate: NDArray[np.float64]
    """θ′, rad/s, shape (N,)."""
    pivot: NDArray[np.float64]
    """y, m, shape (N,)."""
    deflection: NDArray[np.float64] | None
    """Of a rod that bends, m, shape (N,): the root mean square along it; None of a rigid one."""
    slow: float | None
    """Ω of the slow motion, rad/s; None where there is none."""
    growth: float | None
    """Of the slow amplitude, 1/s; None where the run is too short for it."""
    periods: float | None
    """Slow periods swung."""
    fell: bool
    falls: bool
    """Whether it fell, or would if it were followed for longer."""
    stuck: bool
    """Friction held it when the run ended."""

    @property
    def columns(self) -> dict[str, NDArray[np.float64]]:
        """The motion by column."""
        columns = {'time_s': self.time, 'angle_rad': self.angle, 'rate_rad_s': self.rate, 'pivot_m': self.pivot}
        return columns if self.deflection is None else columns | {'deflection_m': self.deflection}

    def __repr__(self) -> str:
        run = self.run
        return describe(
            f'Simulation: {plant_text(run.plant)}, let go at {run.angle:.6g} rad',
            speed=speed_text(run.speed),
            duration=f'{self.time[-1]:.6g} s, {self.time.size} samples',
            slow=speed_text(self.slow),
            growth='none' if self.growth is None else f'{self.growth:.3g} 1/s',
            end='fell' if self.fell else f'{self.angle[-1]:.6g} rad' + ', stuck' * self.stuck,
            unstable='it would fall' if self.falls and not self.fell else 'no',
        )

    def to_pandas(self) -> pd.DataFrame:
        """Return a row a sample."""
        return data_frame(self.columns)

    def plot(self) -> Figure:
        """Draw θ over time."""
        title = f'θ at {speed_text(self.run.speed)}, released at {self.run.angle:g} rad'
        figure: Figure = figures().angle_history(self.time, self.angle, title)
        return figure


def simulate(
    plant: AnyPlant = None,
    *,
    speed: AnyQuantity,
    release: AnyQuantity,
    duration: AnyQuantity,
    phase: AnyQuantity = 0.0,
    linear: bool = False,
    bending_frequency: AnyQuantity | None = None,
    bending_damping: float | None = None,
    sample_rate: AnyQuantity = 1000.0,
) -> Simulation:
    """Release a rod at rest on a shaking pivot, and follow it.

    Parameters
    ----------
    plant
        A `Plant`, or a preset by its name or path; the ideal rod of the report where not given.
    speed
        ω in rad/s, or with a unit as in `'2500 rpm'`.
    release
        θ at rest at time 0, rad.
    duration
        s.
    phase
        p of the pivot's motion, rad: 0 starts it at the bottom of its stroke.
    linear
        Take θ for sin θ.
    bending_frequency
        Of the rod's first bending mode, rad/s, or with a unit as in `'45 Hz'`; the rod is rigid where not given.
    bending_damping
        Of that mode, a share of critical.
    sample_rate
        Hz.

    Returns
    -------
    Simulation
        With arrays of shape (N,), `.to_pandas()` and `.plot()`.

    Raises
    ------
    KapitsaError
        An input cannot be used, or the promised accuracy of 1e-8 rad cannot be kept.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> run = kr.simulate(kr.Plant(), speed='2500 rpm', release='7 deg', duration='1 min')
    >>> run.fell, run.angle.shape, round(run.slow, 3)
    (False, (60001,), 11.954)

    """
    run = Release(
        plant=as_plant(plant),
        speed=to_si('speed', speed, 'rad/s'),
        angle=to_si('release', release, 'rad'),
        phase=to_si('phase', phase, 'rad'),
        linear=linear,
    )
    bending = _bending(bending_frequency, bending_damping)
    seconds, rate = to_si('duration', duration, 's'), to_si('sample_rate', sample_rate, 'Hz')
    motion = run.sampled(seconds, rate) if bending is None else simulate_flexible(run, bending, seconds, rate)
    slow = summarise_run(run, seconds, bending)
    return Simulation(
        run=run,
        time=motion.time,
        angle=motion.angle,
        rate=motion.rate,
        pivot=-run.plant.amplitude * np.cos(run.speed * motion.time + run.phase),
        deflection=motion.deflection if isinstance(motion, FlexibleTrajectory) else None,
        slow=slow.frequency,
        growth=slow.growth,
        periods=slow.periods,
        fell=motion.fell,
        falls=slow.falls or motion.fell,
        stuck=isinstance(motion, Trajectory) and motion.stuck,
    )


def _bending(frequency: AnyQuantity | None, damping: float | None) -> BendingMode | None:
    if frequency is not None:
        return BendingMode(frequency=to_si('bending_frequency', frequency, 'rad/s'), damping=damping or 0.0)
    if damping is not None:
        raise ParameterError('bending_damping: a rigid rod has none, give bending_frequency too')
    return None
