"""`experiment`: the laboratory as a graph of nodes, which records and analyses."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros._api.inputs import as_assumptions, as_instruments, as_plant
from kapitsa_ros._api.result import describe, interval_text, speed_text, speeds_text
from kapitsa_ros.data_frame import data_frame
from kapitsa_ros.reporting.allowances import allowed
from kapitsa_ros.rig.setup import Setup
from kapitsa_ros.units import RPM, counted

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import pandas as pd
    from numpy.typing import NDArray

    from kapitsa_ros._api.inputs import AnyAssumptions, AnyInstruments, AnyPlant


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class ExperimentResult:
    """What the runs of an experiment say; arrays have an entry a run, speeds are in rad/s."""

    bags: tuple[Path, ...]
    speed_reading: NDArray[np.float64]
    """ω by the strobe; nan where it gave none."""
    period: NDArray[np.float64]
    """T of the slow swing by the stopwatch, s; nan where it gave none."""
    fell: NDArray[np.bool_]
    omega_crit: float | None
    """The best estimate."""
    omega_crit_interval: tuple[float | None, float | None] | None
    """95 %; an end that is None is unbounded."""
    inverse_ols: float | None
    ols: float | None
    predicted: float
    truth: float | None
    """Exact threshold of the plant that was simulated."""
    realtime_factor: float
    """Simulated over wall seconds."""
    reset_runs: tuple[int, ...]
    """Numbers of the runs that a call of the service `jigsaw/reset` has cut short."""
    values: Mapping[str, Any]
    """All of it under the names of the command's JSON, speeds in RPM."""

    def __repr__(self) -> str:
        reset = {'reset_runs': ', '.join(map(str, self.reset_runs))} if self.reset_runs else {}
        return describe(
            f'ExperimentResult: {counted(len(self.bags), "run")}, {self.realtime_factor:.0f} times real time',
            speeds_read=speeds_text(self.speed_reading[np.isfinite(self.speed_reading)]),
            critical_speed=speed_text(self.omega_crit, self.omega_crit_interval),
            interval=interval_text(self.omega_crit_interval),
            interval_allows_for=allowed(self.values['assumptions']),
            predicted=speed_text(self.predicted),
            truth=speed_text(self.truth),
            beyond_stated_uncertainty=_percent(self.values['discrepancy_percent']),
            **reset,
        )

    def to_pandas(self) -> pd.DataFrame:
        """Return a row a run."""
        return data_frame(
            {
                'bag': [str(bag) for bag in self.bags],
                'speed_reading_rad_s': self.speed_reading,
                'speed_reading_rpm': self.speed_reading / RPM,
                'period_s': self.period,
                'fell': self.fell,
            }
        )


def experiment(
    plant: AnyPlant = None,
    *,
    instruments: AnyInstruments = '1997',
    protocol: str | Path = '1997',
    seed: int = 1,
    bags: str | Path = 'runs',
    rate: float = 0.0,
    storage: str = 'mcap',
    compression: str = 'zstd',
    composed: bool = False,
    assumptions: AnyAssumptions = None,
    on_progress: Callable[[dict[str, str]], None] | None = None,
) -> ExperimentResult:
    """Run the laboratory: nodes carry out the protocol, each run is recorded to a bag, and all are reduced.

    This starts the graph, in processes of its own; when it returns, or raises, none is left.

    Parameters
    ----------
    plant
        A `Plant`, or a preset by its name or path; the ideal rod of the report where not given.
    instruments
        A set, by its name or path, or `Instruments`.
    protocol
        By its name or path.
    seed
        Of all chance.
    bags
        Folder for the runs, which must not be there yet.
    rate
        Simulated over wall seconds; 0: as fast as it can.
    storage
        Of the bags: mcap or sqlite3.
    compression
        Of the chunks in MCAP: zstd or none, which makes θ(t) quicker to read and files three times as large.
    composed
        Whether the nodes share one process; the bags are the same.
    assumptions
        What the analysis takes for granted: `Assumptions`, or those that are not the usual ones by their names.
    on_progress
        Called with how far the graph is.

    Returns
    -------
    ExperimentResult
        With `.to_pandas()`.

    Raises
    ------
    KapitsaError
        An input cannot be used, a run of that name is there already, or a node died.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> found = kr.experiment('bearing', bags='runs/bearing')  # doctest: +SKIP
    >>> found.omega_crit_interval  # doctest: +SKIP

    """
    from kapitsa_ros.rig.session import run_experiment  # noqa: PLC0415  # rclpy takes its time

    setup = Setup(
        plant=as_plant(plant),
        instruments=as_instruments(instruments),
        protocol=str(protocol),
        seed=seed,
        rate=rate,
        bags=Path(bags),
        storage=storage,
        compression=compression,
        composed=composed,
    )
    values = run_experiment(setup, on_progress or (lambda _: None), as_assumptions(assumptions))
    runs = values['runs']
    interval = values['omega_crit_interval_rpm']
    return ExperimentResult(
        bags=tuple(Path(run['bag']) for run in runs),
        speed_reading=np.array([_speed(run['speed_reading_rpm']) for run in runs], dtype=np.float64),
        period=np.array([run['period_s'] for run in runs], dtype=np.float64),
        fell=np.array([run['fell'] for run in runs], dtype=bool),
        omega_crit=_speed(values['omega_crit_rpm']),
        omega_crit_interval=None if interval is None else (_speed(interval[0]), _speed(interval[1])),
        inverse_ols=_speed(values['inverse_rpm']),
        ols=_speed(values['ols_rpm']),
        predicted=values['predicted_rpm'] * RPM,
        truth=_speed(values['truth_rpm']),
        realtime_factor=values['realtime_factor'],
        reset_runs=tuple(values.get('reset_runs', ())),
        values=values,
    )


def _percent(discrepancy: float | None) -> str:
    return 'none' if not discrepancy else f'{discrepancy:.2g} % of each period allowed for'


def _speed(rpm: float | None) -> float | None:
    return None if rpm is None else rpm * RPM
