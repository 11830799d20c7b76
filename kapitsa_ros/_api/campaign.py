"""`campaign`: many virtual experiments."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros._api.inputs import as_assumptions, as_instruments, as_plant, as_protocol
from kapitsa_ros._api.result import describe, figures, speed_text
from kapitsa_ros.configuration.campaign_ranges import MOST_EXPERIMENTS, ONE_POINT, load_ranges
from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.data_frame import data_frame
from kapitsa_ros.laboratory.campaign import BATCH, Cores, efficiency, perform_at_points, summarise_columns
from kapitsa_ros.laboratory.campaign_file import CampaignFile
from kapitsa_ros.laboratory.campaign_points import campaign_points, identity_of
from kapitsa_ros.laboratory.dask_cluster import DaskCluster
from kapitsa_ros.laboratory.outcomes import Outcomes
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.reporting.allowances import allowed
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    import pandas as pd
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from kapitsa_ros._api.inputs import AnyAssumptions, AnyInstruments, AnyPlant, AnyProtocol
    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.laboratory.campaign import Campaign, Outcome
    from kapitsa_ros.laboratory.campaign_points import CampaignPoint

    Progress = Callable[[Iterator[Outcome], int], Iterable[Outcome]]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class CampaignResult:
    """What many experiments came to; speeds in rad/s, arrays of shape (N,) with an entry an experiment."""

    points: tuple[CampaignPoint, ...]
    """Where nothing is varied, one."""
    point: NDArray[np.int64]
    """Index of the point of each."""
    seed: NDArray[np.int64]
    omega_crit: NDArray[np.float64]
    """nan where the readings gave none."""
    low: NDArray[np.float64]
    """Lower end of the 95 % interval; -inf where it is unbounded."""
    high: NDArray[np.float64]
    """Upper end; inf where it is unbounded."""
    failure: tuple[str | None, ...]
    """Why there is no critical speed; None where there is one."""
    summary: Campaign
    at_points: tuple[Campaign, ...]
    """The summary of each point."""
    wall: float
    """s that the experiments took."""
    assumptions: Assumptions
    """What the analysis took for granted."""
    efficiency: float
    """Seconds of computing in the experiments over those that the workers had."""

    @property
    def truth(self) -> float:
        """Exact threshold of the plant; nan where there are several."""
        truths = {point.truth for point in self.points}
        return truths.pop() if len(truths) == 1 else np.nan

    def __repr__(self) -> str:
        found = self.summary
        return describe(
            f'CampaignResult: {found.experiments} experiments, {found.failed} without a critical speed',
            median=speed_text(found.omega_crit[0]),
            truth=speed_text(self.truth) if np.isfinite(self.truth) else f'of {len(self.points)} points',
            coverage=f'{100.0 * found.coverage:.1f} % of the 95 % intervals hold the truth',
            intervals_allow_for=allowed(asdict(self.assumptions)),
            width=f'{speed_text(found.width)} (median), {found.unbounded} unbounded',
        )

    def to_pandas(self) -> pd.DataFrame:
        """Return a row an experiment, with the values of its factors."""
        each = [self.points[index] for index in self.point.tolist()]
        return data_frame(
            {
                **{name: [point.factors[name] for point in each] for name in self.points[0].factors},
                'seed': self.seed,
                'omega_crit_rad_s': self.omega_crit,
                'omega_crit_rpm': self.omega_crit / RPM,
                'low_rad_s': self.low,
                'high_rad_s': self.high,
                'truth_rad_s': [point.truth for point in each],
            }
        )

    def plot(self) -> Figure:
        """Draw how the critical speeds scatter about the truth; where that differs, over it."""
        seen = np.isfinite(self.omega_crit)
        if np.isfinite(self.truth):
            figure: Figure = figures().critical_speeds(self.omega_crit[seen], self.truth)
        else:
            truth = np.array([self.points[index].truth for index in self.point.tolist()])
            figure = figures().deviations_of_critical_speeds(self.omega_crit[seen] / truth[seen])
        return figure


def campaign(
    plant: AnyPlant = None,
    *,
    experiments: int | None = None,
    instruments: AnyInstruments = '1997',
    protocol: AnyProtocol = '1997',
    ranges: str | Path | None = None,
    output: str | Path | None = None,
    resume: bool = False,
    scheduler: str | None = None,
    assumptions: AnyAssumptions = None,
    progress: Progress | None = None,
) -> CampaignResult:
    """Carry out many whole experiments in process, and count how often their intervals tell the truth.

    Parameters
    ----------
    plant
        A `Plant`, or a preset by its name or path; the ideal rod of the report where not given.
    experiments
        How many at each point of the ranges, with the seeds 1, 2, 3..., which go on from point to point.
    instruments
        A set, by its name or path, or `Instruments`.
    protocol
        By its name or path.
    ranges
        Path of a YAML file with what is varied (see `load_ranges`); its factors replace what the other arguments say.
    output
        A Parquet file for the outcomes, which must not be there yet. What is finished is kept beside it, should the
        campaign end early.
    resume
        Go on with what is there.
    scheduler
        Address of a Dask cluster; without it all cores of this machine compute, in processes of their own (a script
        that calls this needs `if __name__ == '__main__':` where processes are spawned).
    assumptions
        What the analysis takes for granted: `Assumptions`, or those that are not the usual ones by their names.
    progress
        Wraps the outcomes as they come, as `rich.progress.track` does; its second argument is how many come.

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
    simulated = SimulatedExperiment(
        plant=as_plant(plant), instruments=as_instruments(instruments), protocol=as_protocol(protocol), seed=0
    )
    varied = ONE_POINT if ranges is None else load_ranges(Path(ranges))
    each = experiments if experiments is not None else varied.experiments
    if each is None:
        raise ConfigurationError('say how many experiments: `experiments`, or a line of the file of ranges')
    if each * len(varied.points) > MOST_EXPERIMENTS:
        asked = f'{each} experiments at each of {len(varied.points)} points'
        raise ConfigurationError(f'{asked}: at most {MOST_EXPERIMENTS} in all')
    points = campaign_points(varied, simulated)
    taken = as_assumptions(assumptions)
    if resume and output is None:
        raise ConfigurationError('to go on with a campaign takes its output file')
    file = None
    if output is not None:
        identity = identity_of(points, each, asdict(taken))
        file = CampaignFile(path=Path(output), points=points, experiments=each, identity=identity, resume=resume)
    missing = [range(each * len(points))] if file is None else file.missing()
    workers = DaskCluster(scheduler) if scheduler is not None else Cores()
    begin = time.perf_counter()
    coming = perform_at_points([point.experiment for point in points], each, workers, taken, missing)
    kept = coming if file is None else _kept(coming, file)
    fresh = Outcomes(kept if progress is None else progress(kept, sum(map(len, missing))))
    wall = time.perf_counter() - begin
    outcomes = fresh if file is None else file.finish()
    omega_crit, low, high = outcomes.omega_crit, outcomes.low, outcomes.high
    truth = np.repeat([point.truth for point in points], each)
    at_points = (slice(number * each, (number + 1) * each) for number in range(len(points)))
    return CampaignResult(
        points=points,
        point=np.repeat(np.arange(len(points)), each),
        seed=outcomes.seed,
        omega_crit=omega_crit,
        low=low,
        high=high,
        failure=outcomes.failure,
        summary=summarise_columns(omega_crit, low, high, truth),
        at_points=tuple(summarise_columns(omega_crit[at], low[at], high[at], truth[at]) for at in at_points),
        wall=wall,
        assumptions=taken,
        efficiency=efficiency(fresh.seconds, wall, workers.count),
    )


def _kept(outcomes: Iterator[Outcome], file: CampaignFile) -> Iterator[Outcome]:
    """Pass outcomes on and write them as they come, whatever ends them."""
    waiting: list[Outcome] = []
    try:
        for outcome in outcomes:
            if waiting and outcome.seed != waiting[-1].seed + 1:  # those between are there already
                file.add(waiting)
                waiting = []
            waiting.append(outcome)
            if len(waiting) == BATCH:
                file.add(waiting)
                waiting = []
            yield outcome
    finally:
        if waiting:
            file.add(waiting)
