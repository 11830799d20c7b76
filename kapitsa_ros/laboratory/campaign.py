"""Many virtual experiments, each with a seed of its own, and how often their intervals tell the truth."""

from __future__ import annotations

import math
import os
import signal
import time
from collections import deque
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Protocol, TypeAlias

import numpy as np

from kapitsa_ros.analysis.assumptions import DEFAULT_ASSUMPTIONS
from kapitsa_ros.analysis.critical_speed import fit_timings, ruler_of
from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.line_fit import fit_inverse_ols, fit_ols
from kapitsa_ros.analysis.timing_row import timing_rows
from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.laboratory.errors import WorkerLostError
from kapitsa_ros.laboratory.outcomes import Outcomes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from concurrent.futures import Future

    from numpy.typing import NDArray

    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.analysis.critical_speed import CriticalSpeed, Evidence
    from kapitsa_ros.analysis.line_fit import LineFit
    from kapitsa_ros.analysis.table import Readings
    from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment

BATCH = 16
"""Experiments that a worker is given at once."""
AHEAD = 4
"""Batches that wait for each worker, so that none is idle."""
NOT_TIMED = 'no swing could be timed'
"""Why there is no critical speed where all swings were too few, too short or none."""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What one experiment came to; speeds in rad/s."""

    seed: int
    omega_crit: float | None
    """By the direct fit; None where the readings gave none."""
    interval: tuple[float | None, float | None]
    ols: float | None
    inverse_ols: float | None
    seconds: float
    """Of computing."""
    failure: str | None = None
    """Why there is no critical speed, in words; None where there is one."""


@dataclass(frozen=True, kw_only=True)
class Campaign:
    """What many experiments came to together; speeds in rad/s, nan where there is none."""

    experiments: int
    failed: int
    """Experiments whose readings gave no critical speed."""
    omega_crit: tuple[float, float, float]
    """Median, 16th and 84th percentile."""
    coverage: float
    """Share of intervals that hold the truth, of the experiments that gave one."""
    width: float
    """Median width of the intervals bounded on both sides."""
    unbounded: int


def perform(experiment: SimulatedExperiment, seed: int, assumptions: Assumptions = DEFAULT_ASSUMPTIONS) -> Outcome:
    """Carry out one experiment and reduce its readings; where that is refused, the outcome says why."""
    begin = time.process_time()
    fit: CriticalSpeed | None = None
    ols = inverse = None
    failure: str | None = None
    try:
        runs = replace(experiment, seed=seed).runs()
        rows = timing_rows(runs, assumptions.dial_u)
        found = fit_timings(rows, ruler_of(runs[0]), experiment.plant.gravity, assumptions)
    except KapitsaError as error:
        failure = str(error)
    else:
        fit = found.best
        ols, inverse = _line(fit_ols, found.evidence), _line(fit_inverse_ols, found.evidence)
        failure = NOT_TIMED if fit is None else None
    return Outcome(
        seed=seed,
        omega_crit=fit.omega_crit if fit else None,
        interval=fit.interval if fit else (None, None),
        ols=ols,
        inverse_ols=inverse,
        seconds=time.process_time() - begin,
        failure=failure,
    )


class Workers(Protocol):
    """Whoever computes: the cores of this machine, or a cluster."""

    @property
    def count(self) -> int:
        """How many batches are under way at once."""

    def map(self, function: Callable[[Batch], list[Outcome]], batches: Iterable[Batch]) -> Iterator[list[Outcome]]:
        """Apply a function to many batches, which are asked for as they are needed; results come in their order."""


class Cores:
    """All cores that this process may use, a process each."""

    count = len(os.sched_getaffinity(0))

    def map(self, function: Callable[[Batch], list[Outcome]], batches: Iterable[Batch]) -> Iterator[list[Outcome]]:
        """Apply a function to many batches, which are asked for as they are needed; results come in their order.

        Raises
        ------
        WorkerLostError
            One of the processes was killed.

        """
        with ProcessPoolExecutor(self.count, initializer=_leave_interrupts_to_the_parent) as pool:
            under_way: deque[Future[list[Outcome]]] = deque()
            try:
                for batch in batches:
                    under_way.append(pool.submit(function, batch))
                    if len(under_way) > AHEAD * self.count:
                        yield under_way.popleft().result()
                while under_way:
                    yield under_way.popleft().result()
            except BrokenProcessPool as error:
                raise WorkerLostError(
                    'a process that computed was killed, as for want of memory: what was finished is kept where there '
                    'is an output file, go on by --resume'
                ) from error


def _leave_interrupts_to_the_parent() -> None:
    # A terminal sends them to all; the parent stops the workers, by a signal that its command takes for an interrupt.
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


def perform_all(
    experiment: SimulatedExperiment,
    experiments: int,
    workers: Workers | None = None,
    assumptions: Assumptions = DEFAULT_ASSUMPTIONS,
) -> Iterator[Outcome]:
    """Carry out many experiments, with seeds from 1 on, by default on all cores of this machine.

    Outcomes come in the order of their seeds and depend on nothing else.

    Raises
    ------
    AnalysisError
        Fewer than one experiment.

    """
    yield from perform_at_points([experiment], experiments, workers, assumptions)


def perform_at_points(
    points: Sequence[SimulatedExperiment],
    experiments: int,
    workers: Workers | None = None,
    assumptions: Assumptions = DEFAULT_ASSUMPTIONS,
    missing: Sequence[range] | None = None,
) -> Iterator[Outcome]:
    """Carry out many experiments at each of several points, with seeds from 1 on that go on from point to point.

    No chance is shared between points, so all outcomes together are independent of one another. They come point by
    point in the order of their seeds. Where only some are `missing`, counted from 0 on, the others are left out.

    Raises
    ------
    AnalysisError
        Fewer than one experiment.

    """
    if experiments < 1:
        raise AnalysisError(f'{experiments} experiments: carry out one or more')
    function = partial(_perform_batch, assumptions=assumptions)
    due = [range(len(points) * experiments)] if missing is None else missing
    for outcomes in (workers or Cores()).map(function, _batches(points, experiments, due)):
        yield from outcomes


Batch: TypeAlias = 'tuple[SimulatedExperiment, range]'
"""An experiment, and the seeds with which it is carried out."""


def _batches(points: Sequence[SimulatedExperiment], experiments: int, due: Sequence[range]) -> Iterator[Batch]:
    for numbers in due:
        begin = numbers.start
        while begin < numbers.stop:
            point = begin // experiments
            end = min(begin + BATCH, (point + 1) * experiments, numbers.stop)
            yield points[point], range(begin + 1, end + 1)
            begin = end


def _perform_batch(batch: Batch, assumptions: Assumptions) -> list[Outcome]:
    experiment, seeds = batch
    return [perform(experiment, seed, assumptions) for seed in seeds]


def efficiency(seconds: float, wall: float, workers: int) -> float:
    """Return the seconds of computing in the experiments over those that the workers had in `wall` seconds."""
    return seconds / (wall * workers) if wall else math.nan


def summarise(outcomes: Iterable[Outcome], truth: float) -> Campaign:
    """Sum up outcomes against the true critical speed, rad/s."""
    found = Outcomes(outcomes)
    return summarise_columns(found.omega_crit, found.low, found.high, np.full(len(found), truth))


def summarise_columns(
    omega_crit: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    truth: NDArray[np.float64],
) -> Campaign:
    """Sum up outcomes against the true critical speed of each, rad/s.

    Parameters
    ----------
    omega_crit, low, high
        Critical speeds and their intervals as in `Outcomes`, shape (N,).
    truth
        Shape (N,).

    """
    given = np.isfinite(omega_crit)
    count = int(given.sum())
    held = int(((low <= truth) & (truth <= high))[given].sum())
    quantiles = np.quantile(omega_crit[given], (0.5, 0.16, 0.84)) if count else np.full(3, math.nan)
    widths = (high - low)[given & np.isfinite(low) & np.isfinite(high)]
    return Campaign(
        experiments=omega_crit.size,
        failed=omega_crit.size - count,
        omega_crit=(float(quantiles[0]), float(quantiles[1]), float(quantiles[2])),
        coverage=held / count if count else math.nan,
        width=float(np.median(widths)) if widths.size else math.nan,
        unbounded=count - widths.size,
    )


def _line(fit: Callable[[Readings], LineFit], evidence: Evidence) -> float | None:
    try:
        return fit(evidence.timed).omega_crit
    except AnalysisError:
        return None
