"""A recorded motion as one series."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros.data_frame import data_frame, dataset
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.units import counted

if TYPE_CHECKING:
    from collections.abc import Iterable

    import pandas as pd
    import xarray as xr
    from numpy.typing import NDArray

    from kapitsa_ros.physics.sampled_motion import SampledMotion

_WIDEST, _FASTEST = 1e4, 1e6
"""rad, rad/s: beyond lies damage, which fits would choke on."""


@dataclass(frozen=True, eq=False)
class Motion:
    """A recorded motion as one series; shape (N,) each, SI units."""

    stamps_ns: np.ndarray[Any, np.dtype[np.int64]]
    angle: np.ndarray[Any, np.dtype[np.float64]]
    rate: np.ndarray[Any, np.dtype[np.float64]]
    gaps: int
    """Places where a sample or a step is missing, before the first one too."""
    lost: float
    """Seconds of motion missing there."""

    @property
    def sample_rate(self) -> float:
        """Samples a second.

        Raises
        ------
        BagError
            Some are missing, or they are not equally far apart: what takes them for even would be wrong.

        """
        periods = np.diff(self.stamps_ns)
        if self.gaps:
            raise BagError(
                f'{self.lost:g} s of the motion are missing in {counted(self.gaps, "place")}: it has no one rate'
            )
        if not periods.size or np.ptp(periods):
            raise BagError('the samples of the motion are not equally far apart: it has no one rate')
        return float(SECOND / periods[0])

    def to_pandas(self) -> pd.DataFrame:
        """Return a row a sample, times from the first on; `attrs` has `gaps` and `lost_s`."""
        frame = data_frame(self._columns())
        frame.attrs |= {'gaps': self.gaps, 'lost_s': self.lost}
        return frame

    def to_xarray(self) -> xr.Dataset:
        """Return angle and rate over `time_s`, from the first sample on; `attrs` has `gaps` and `lost_s`."""
        units = {'time_s': 's', 'angle_rad': 'rad', 'rate_rad_s': 'rad/s'}
        variables = {name: ('time_s', values, {'units': units[name]}) for name, values in self._columns().items()}
        return dataset(variables, {'gaps': self.gaps, 'lost_s': self.lost})

    def _columns(self) -> dict[str, np.ndarray[Any, np.dtype[np.float64]]]:
        seconds = (self.stamps_ns - self.stamps_ns[:1]) / SECOND
        return {'time_s': seconds, 'angle_rad': self.angle, 'rate_rad_s': self.rate}


def joined_motion(blocks: Iterable[tuple[int, int, SampledMotion]], begin_ns: int | None = None) -> Motion:
    """Return the motion that blocks make, of which each holds both its ends.

    Parameters
    ----------
    blocks
        Step, stamp (ns) and motion of each, in the order of the steps.
    begin_ns
        Stamp at which they ought to begin; None where that is not known but for the number of the first step, 0.

    Raises
    ------
    WireError
        No pendulum moves so.

    """
    stamps: list[Any] = []
    angles, rates = [], []
    late, count = 0.0, 0
    for step, stamp, samples in blocks:
        times = np.arange(samples.position.size) * round(samples.period * SECOND)
        if not stamps and begin_ns is not None and stamp > begin_ns:
            count, late = 1, (stamp - begin_ns) / SECOND - samples.period
        elif not stamps and begin_ns is None and step > 0:
            count, late = 1, step * samples.period * (samples.position.size - 1)
        stamps.append(stamp + times)
        angles.append(samples.position)
        rates.append(samples.rate)
    if not stamps:
        empty = np.array([])
        return Motion(empty.astype(np.int64), empty, empty, 0, 0.0)
    angle, rate = np.concatenate(angles), np.concatenate(rates)
    if not is_motion(angle, rate):
        raise WireError(f'a motion that reaches {np.abs(angle).max():g} rad and {np.abs(rate).max():g} rad/s is none')
    joined = np.concatenate(stamps)
    periods = np.diff(joined)
    # A block begins at the stamp at which the last one ended.
    fresh = np.concatenate(([True], periods > 0))
    period = np.median(periods[periods > 0])
    gaps = periods[periods > period]
    lost = float((gaps - period).sum()) / SECOND
    return Motion(joined[fresh], angle[fresh], rate[fresh], gaps.size + count, lost + late)


def is_motion(angle: NDArray[np.float64], rate: NDArray[np.float64]) -> bool:
    """Whether a pendulum can move so; angle in rad, rate in rad/s."""
    limits = ((angle, _WIDEST), (rate, _FASTEST))
    return all(-limit <= values.min() and values.max() <= limit for values, limit in limits)
