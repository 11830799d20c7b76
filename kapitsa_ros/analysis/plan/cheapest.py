"""The protocol that reaches an aim in the least time at the bench."""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.critical_speed.assumptions import DEFAULT_ASSUMPTIONS
from kapitsa_ros.analysis.critical_speed.likelihood import FLOOR
from kapitsa_ros.analysis.critical_speed.ruler import RULER_SIGMA
from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.plan.sensitivity import Sensitivity, sensitivity
from kapitsa_ros.analysis.strobe_alias import dial_sigma
from kapitsa_ros.operator.scripted_operator import CATCH
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.theory.floquet import omega_crit_exact
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
    from kapitsa_ros.physics.plant import Plant

NORMAL_95 = 1.959964
FASTEST = 3000 * RPM
"""rad/s; the fastest the jigsaw of 1997 was thought of (report, section 7)."""

_NEAREST = 1.1  # of the threshold: nearer, a rod that is not quite as planned falls
_SPEEDS = 9
_RUNS = (2, 3)  # one would do beside a ruler, but leave nothing to check it by
_SWINGS = (1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20)
_REPEATS = (1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 75, 100)
_SET_UP = 5.0  # s: the shaft runs up, the strobe is read


@dataclass(frozen=True, kw_only=True)
class Plan:
    """A protocol and what is expected of it."""

    speeds: tuple[float, ...]
    """ω of each run, rad/s."""
    swings: int
    """Full swings a timing."""
    repeats: int
    """Timings a run."""
    expected_percent: float
    """Half the width of the 95 % interval, per cent of the critical speed."""
    seconds: float
    """Time at the bench."""


def cheapest_plan(
    plant: Plant,
    instruments: Instruments,
    target_percent: float,
    release: float = 0.12,
    fastest: float = FASTEST,
) -> Plan:
    """Find the protocol of least bench time whose 95 % interval is expected within ±target.

    The expectation is the Cramér-Rao bound of the direct fit: Fisher information of the exact curve for the threshold,
    λ (with the ruler's prior) and c (with its own), at the errors of these instruments. Friction limits the swings: a
    run is timed for no longer than its motion lasts.

    Raises
    ------
    AnalysisError
        The target is no percentage above 0, the release is upright, or no protocol tried reaches the target.

    """
    if not 0.0 < target_percent < math.inf:
        raise AnalysisError(f'target {target_percent} %: give a percentage above 0')
    if release == 0.0:
        raise AnalysisError('a release at 0 rad: an upright rod does not swing, let it go at an angle')
    runs = _candidates(plant, release, fastest)
    best: Plan | None = None
    closest = math.inf
    for count in _RUNS:
        for chosen in combinations(runs, count):
            for swings in (number for number in _SWINGS if number <= min(run.swings for run in chosen)):
                plan = _fewest_repeats(chosen, instruments, plant, swings, target_percent)
                closest = min(closest, plan.expected_percent)
                if plan.expected_percent <= target_percent and (best is None or plan.seconds < best.seconds):
                    best = plan
    if best is None:
        raise AnalysisError(f'no protocol tried reaches {target_percent:g} %: the best comes to {closest:.2g} %')
    return best


def _fewest_repeats(
    runs: Sequence[Sensitivity], instruments: Instruments, plant: Plant, swings: int, target_percent: float
) -> Plan:
    """Return the plan of fewest repeats that reaches the target, or that of most."""

    def expected(repeats: int) -> float:
        return expected_percent(runs, instruments, plant, swings, repeats)

    index = bisect_left(_REPEATS, -target_percent, hi=len(_REPEATS) - 1, key=lambda repeats: -expected(repeats))
    repeats = _REPEATS[index]
    return Plan(
        speeds=tuple(run.speed for run in runs),
        swings=swings,
        repeats=repeats,
        expected_percent=expected(repeats),
        seconds=sum(_SET_UP + repeats * (CATCH + (0.75 + swings) * run.period) for run in runs),
    )


def expected_percent(
    runs: Sequence[Sensitivity], instruments: Instruments, plant: Plant, swings: int, repeats: int
) -> float:
    """Return half the width of the 95 % interval to expect, per cent of the critical speed."""
    press = math.sqrt(_press_variance(instruments.stopwatch) / repeats) / swings
    dial = dial_sigma(instruments.strobe)
    information = np.diag([0.0, (plant.amplitude / RULER_SIGMA) ** 2, DEFAULT_ASSUMPTIONS.light_damping**-2])
    for run in runs:
        gradient = run.gradient(swings)
        sigma = math.hypot(press / run.period, run.of_speed * dial, FLOOR)
        information += np.outer(gradient, gradient) / sigma**2
    return 100.0 * NORMAL_95 * math.sqrt(np.linalg.inv(information)[0, 0])


def _press_variance(stopwatch: StopwatchSettings) -> float:
    return 2.0 * stopwatch.reaction_jitter**2 + stopwatch.display_resolution**2 / 12.0


def _candidates(plant: Plant, release: float, fastest: float) -> list[Sensitivity]:
    try:
        threshold = omega_crit_exact(plant)
    except PhysicsError as error:
        raise AnalysisError(f'this plant has no critical speed to plan for ({error})') from error
    if fastest <= _NEAREST * threshold:
        raise AnalysisError(f'the critical speed is {threshold / RPM:.0f} RPM: a jigsaw that slow never holds it up')
    speeds = np.geomspace(_NEAREST * threshold, fastest, _SPEEDS)
    rounded = sorted({10.0 * RPM * round(float(speed) / (10.0 * RPM)) for speed in speeds})
    runs = [sensitivity(plant, speed, release, _SWINGS[-1]) for speed in rounded if speed > 0.0]
    found = [run for run in runs if run is not None]
    if len(found) < _RUNS[0]:
        where = f'at {found[0].speed / RPM:.0f} RPM alone' if found else 'at none of the speeds tried'
        raise AnalysisError(
            f'a swing can be timed {where}, and a plan takes {_RUNS[0]} speeds: elsewhere the rod falls, or friction '
            'stops it within one period'
        )
    return found
