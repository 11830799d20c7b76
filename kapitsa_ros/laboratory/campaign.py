"""Many virtual experiments, each with a seed of its own, and how often their intervals tell the truth."""

from __future__ import annotations

import math
import os
import signal
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Protocol

import numpy as np

from kapitsa_ros.analysis.critical_speed import fit_timings, ruler_of
from kapitsa_ros.analysis.critical_speed.assumptions import DEFAULT_ASSUMPTIONS
from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.line_fit import fit_inverse_ols, fit_ols
from kapitsa_ros.analysis.timing_row import timing_rows
from kapitsa_ros.units import is_within

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from kapitsa_ros.analysis.critical_speed import Evidence
    from kapitsa_ros.analysis.critical_speed.assumptions import Assumptions
    from kapitsa_ros.analysis.line_fit import LineFit
    from kapitsa_ros.analysis.table import Readings
    from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment


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

    def covers(self, truth: float) -> bool:
        """Whether the interval holds the truth; an end that is unbounded excludes nothing."""
        return is_within(truth, self.interval)


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
    """Carry out one experiment and reduce its readings."""
    begin = time.process_time()
    seeded = replace(experiment, seed=seed)
    runs = seeded.runs()
    rows = timing_rows(runs, assumptions.dial_u)
    found = fit_timings(rows, ruler_of(runs[0]), experiment.plant.gravity, assumptions)
    fit, evidence = found.best, found.evidence
    return Outcome(
        seed=seed,
        omega_crit=fit.omega_crit if fit else None,
        interval=fit.interval if fit else (None, None),
        ols=_line(fit_ols, evidence),
        inverse_ols=_line(fit_inverse_ols, evidence),
        seconds=time.process_time() - begin,
    )


class Workers(Protocol):
    """Whoever computes: the cores of this machine, or a cluster."""

    @property
    def count(self) -> int:
        """How many experiments are under way at once."""

    def map(self, function: Callable[[int], Outcome], seeds: Iterable[int]) -> Iterator[Outcome]:
        """Apply a function to many seeds; outcomes come in the order of the seeds."""


class Cores:
    """All cores that this process may use, a process each."""

    count = len(os.sched_getaffinity(0))

    def map(self, function: Callable[[int], Outcome], seeds: Iterable[int]) -> Iterator[Outcome]:
        """Apply a function to many seeds; outcomes come in the order of the seeds."""
        with ProcessPoolExecutor(self.count, initializer=_leave_interrupts_to_the_parent) as pool:
            yield from pool.map(function, seeds)


def _leave_interrupts_to_the_parent() -> None:
    # A terminal sends them to all; the parent stops the workers.
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)


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
    if experiments < 1:
        raise AnalysisError(f'{experiments} experiments: carry out one or more')
    yield from (workers or Cores()).map(
        partial(perform, experiment, assumptions=assumptions), range(1, experiments + 1)
    )


def efficiency(outcomes: Sequence[Outcome], wall: float, workers: int) -> float:
    """Return the seconds of computing in the experiments over those that the workers had in `wall` seconds."""
    return sum(outcome.seconds for outcome in outcomes) / (wall * workers)


def summarise(outcomes: Sequence[Outcome], truth: float) -> Campaign:
    """Sum up outcomes against the true critical speed, rad/s."""
    given = [outcome for outcome in outcomes if outcome.omega_crit is not None]
    speeds = np.array([outcome.omega_crit for outcome in given], dtype=np.float64)
    quantiles = np.quantile(speeds, (0.5, 0.16, 0.84)) if given else np.full(3, math.nan)
    widths = [
        high - low for low, high in (outcome.interval for outcome in given) if low is not None and high is not None
    ]
    return Campaign(
        experiments=len(outcomes),
        failed=len(outcomes) - len(given),
        omega_crit=(float(quantiles[0]), float(quantiles[1]), float(quantiles[2])),
        coverage=sum(outcome.covers(truth) for outcome in given) / len(given) if given else math.nan,
        width=float(np.median(widths)) if widths else math.nan,
        unbounded=len(given) - len(widths),
    )


def _line(fit: Callable[[Readings], LineFit], evidence: Evidence) -> float | None:
    try:
        return fit(evidence.timed).omega_crit
    except AnalysisError:
        return None
