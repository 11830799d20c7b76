"""`campaign`: many virtual experiments."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros._api.inputs import as_assumptions, as_instruments, as_plant, as_protocol
from kapitsa_ros._api.result import describe, figures, speed_text
from kapitsa_ros.data_frame import data_frame
from kapitsa_ros.laboratory.campaign import Cores, efficiency, perform_all, summarise
from kapitsa_ros.laboratory.dask_cluster import DaskCluster
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.physics.theory.play import omega_crit_with_play
from kapitsa_ros.reporting.allowances import allowed
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    import pandas as pd
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from kapitsa_ros._api.inputs import AnyAssumptions, AnyInstruments, AnyPlant, AnyProtocol
    from kapitsa_ros.analysis.critical_speed.assumptions import Assumptions
    from kapitsa_ros.laboratory.campaign import Campaign, Outcome

    Progress = Callable[[Iterator[Outcome]], Iterable[Outcome]]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class CampaignResult:
    """What many experiments came to; speeds in rad/s, arrays of shape (N,) with an entry an experiment."""

    seed: NDArray[np.int64]
    omega_crit: NDArray[np.float64]
    """nan where the readings gave none."""
    low: NDArray[np.float64]
    """Lower end of the 95 % interval; -inf where it is unbounded."""
    high: NDArray[np.float64]
    """Upper end; inf where it is unbounded."""
    truth: float
    """Exact threshold of the plant."""
    summary: Campaign
    wall: float
    """s that the experiments took."""
    assumptions: Assumptions
    """What the analysis took for granted."""
    efficiency: float
    """Seconds of computing in the experiments over those that the workers had."""

    def __repr__(self) -> str:
        found = self.summary
        return describe(
            f'CampaignResult: {found.experiments} experiments, {found.failed} without a critical speed',
            median=speed_text(found.omega_crit[0]),
            truth=speed_text(self.truth),
            coverage=f'{100.0 * found.coverage:.1f} % of the 95 % intervals hold the truth',
            intervals_allow_for=allowed(asdict(self.assumptions)),
            width=f'{speed_text(found.width)} (median), {found.unbounded} unbounded',
        )

    def to_pandas(self) -> pd.DataFrame:
        """Return a row an experiment."""
        return data_frame(
            {
                'seed': self.seed,
                'omega_crit_rad_s': self.omega_crit,
                'omega_crit_rpm': self.omega_crit / RPM,
                'low_rad_s': self.low,
                'high_rad_s': self.high,
            }
        )

    def plot(self) -> Figure:
        """Draw how the critical speeds scatter about the truth."""
        figure: Figure = figures().critical_speeds(self.omega_crit[np.isfinite(self.omega_crit)], self.truth)
        return figure


def campaign(
    plant: AnyPlant = None,
    *,
    experiments: int,
    instruments: AnyInstruments = '1997',
    protocol: AnyProtocol = '1997',
    scheduler: str | None = None,
    assumptions: AnyAssumptions = None,
    progress: Progress = iter,
) -> CampaignResult:
    """Carry out many whole experiments in process, and count how often their intervals tell the truth.

    Parameters
    ----------
    plant
        A `Plant`, or a preset by its name or path; the ideal rod of the report where not given.
    experiments
        How many, with the seeds 1, 2, 3...
    instruments
        A set, by its name or path, or `Instruments`.
    protocol
        By its name or path.
    scheduler
        Address of a Dask cluster; without it all cores of this machine compute, in processes of their own (a script
        that calls this needs `if __name__ == '__main__':` where processes are spawned).
    assumptions
        What the analysis takes for granted: `Assumptions`, or those that are not the usual ones by their names.
    progress
        Wraps the outcomes as they come, as `rich.progress.track` does.

    Returns
    -------
    CampaignResult
        With `.to_pandas()` and `.plot()`.

    Raises
    ------
    KapitsaError
        An input cannot be used, or the cluster does not answer.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> kr.campaign(experiments=4).omega_crit.shape
    (4,)

    """
    rod = as_plant(plant)
    simulated = SimulatedExperiment(
        plant=rod, instruments=as_instruments(instruments), protocol=as_protocol(protocol), seed=0
    )
    truth = omega_crit_with_play(rod)
    workers = DaskCluster(scheduler) if scheduler else Cores()
    taken = as_assumptions(assumptions)
    begin = time.perf_counter()
    outcomes = list(progress(perform_all(simulated, experiments, workers, taken)))
    wall = time.perf_counter() - begin
    return CampaignResult(
        seed=np.array([outcome.seed for outcome in outcomes]),
        omega_crit=np.array([outcome.omega_crit for outcome in outcomes], dtype=np.float64),
        low=_ends([outcome.interval[0] for outcome in outcomes], -np.inf),
        high=_ends([outcome.interval[1] for outcome in outcomes], np.inf),
        truth=truth,
        summary=summarise(outcomes, truth),
        wall=wall,
        assumptions=taken,
        efficiency=efficiency(outcomes, wall, workers.count),
    )


def _ends(ends: list[float | None], unbounded: float) -> NDArray[np.float64]:
    return np.array([unbounded if end is None else end for end in ends])
