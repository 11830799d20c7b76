"""`stability_map`: where the upright rod is stable, over speed and amplitude."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros._api.inputs import as_plant
from kapitsa_ros._api.result import describe, figures, speeds_text
from kapitsa_ros.data_frame import data_frame
from kapitsa_ros.physics import theory as physics
from kapitsa_ros.quantities import to_si_array
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from kapitsa_ros._api.inputs import AnyPlant
    from kapitsa_ros.physics.plant import Plant
    from kapitsa_ros.quantities import AnyQuantities


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class StabilityRegion:
    """Upright stability over amplitudes (rows) and speeds (columns)."""

    plant: Plant
    speed: NDArray[np.float64]
    """ω, rad/s, shape (N,)."""
    amplitude: NDArray[np.float64]
    """λ, m, shape (M,)."""
    stable: NDArray[np.bool_]
    """Shape (M, N)."""
    half_trace: NDArray[np.float64]
    """D of the undamped companion, shape (M, N): its error is below 1e-10 of max(1, |D|)."""

    def __repr__(self) -> str:
        low, high = self.amplitude[[0, -1]]
        return describe(
            f'StabilityRegion: rod of {self.plant.length:.6g} m',
            speeds=speeds_text(self.speed),
            amplitudes=f'{self.amplitude.size} of {low:.6g} m to {high:.6g} m',
            stable=f'{100.0 * self.stable.mean():.1f} % of the points',
        )

    def to_pandas(self) -> pd.DataFrame:
        """Return a row a point."""
        amplitude, speed = (axis.ravel() for axis in np.meshgrid(self.amplitude, self.speed, indexing='ij'))
        columns = {'speed_rad_s': speed, 'speed_rpm': speed / RPM, 'amplitude_m': amplitude}
        return data_frame(columns | {'stable': self.stable.ravel(), 'half_trace': self.half_trace.ravel()})

    def plot(self) -> Figure:
        """Draw the stable region."""
        figure: Figure = figures().stability_region(self.speed, self.amplitude, self.stable)
        return figure


def stability_map(plant: AnyPlant = None, *, speed: AnyQuantities, amplitude: AnyQuantities) -> StabilityRegion:
    """Map where the upright rod is stable: 10⁶ points take some milliseconds.

    Parameters
    ----------
    plant
        A `Plant`, or a preset by its name or path; its own amplitude does not enter.
    speed
        ω in rad/s, or with a unit, shape (N,), ascending.
    amplitude
        λ in m, or with a unit, shape (M,), ascending.

    Returns
    -------
    StabilityRegion
        With arrays of shape (M, N), `.to_pandas()` and `.plot()`.

    Raises
    ------
    KapitsaError
        An input cannot be used, or the promised accuracy cannot be kept.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> kr.stability_map(speed=['1200 rpm', '2500 rpm'], amplitude=['0.5 in']).stable
    array([[False,  True]])

    """
    rod = as_plant(plant)
    omega, stroke = to_si_array('speed', speed, 'rad/s'), to_si_array('amplitude', amplitude, 'm')
    found = physics.stability_map(rod, omega, stroke)
    return StabilityRegion(plant=rod, speed=omega, amplitude=stroke, stable=found.stable, half_trace=found.half_trace)
