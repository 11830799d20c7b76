"""The protocol that reaches an aim in the least time at the bench."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.assumptions import DEFAULT_ASSUMPTIONS
from kapitsa_ros.analysis.critical_speed.likelihood import FLOOR
from kapitsa_ros.analysis.critical_speed.posterior import rods_of_prior
from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.plan.promise import Promise, press_variance
from kapitsa_ros.analysis.plan.sensitivity import Sensitivity, sensitivity
from kapitsa_ros.analysis.ruler import Ruler
from kapitsa_ros.analysis.strobe_alias import dial_sigma
from kapitsa_ros.operator.scripted_operator import CATCH
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.theory.floquet import omega_crit_exact
from kapitsa_ros.units import NORMAL_95, RPM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.physics.plant import Plant

FASTEST = 3000 * RPM
"""rad/s; the fastest the jigsaw of 1997 was thought of (report, section 7)."""

_NEAREST = 1.1  # of the threshold: nearer, a rod that is not quite as planned falls
_SPEEDS = 9
_RUNS = (2, 3)  # one would do beside a ruler, but leave nothing to check it by
_SWINGS = (1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20)
_REPEATS = (1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 75, 100)
_AIMS = 8  # at the bound, until the interval meets the target
_CLOSE, _CLOSER = 0.9, 0.98  # of the target: near enough, and what the next aim is to come to
_FARTHEST = 3.0  # targets
_RODS = 512  # of the prior
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
    *,
    release: float = 0.12,
    fastest: float = FASTEST,
    assumptions: Assumptions = DEFAULT_ASSUMPTIONS,
) -> Plan:
    """Find the protocol of least bench time whose 95 % interval is expected within ±target.

    Protocols are compared by the Cramér-Rao bound of the direct fit: Fisher information of the exact curve for the
    threshold, λ and c, with the spread of the two that ruler and assumptions leave, at the errors of these
    instruments. What is expected of the one that is chosen is the interval itself (see `Promise`); where it is wider or
    narrower than the bound, the aim at the bound is moved until it is met. Friction limits the swings: a run is timed
    for no longer than its motion lasts.

    Raises
    ------
    AnalysisError
        The target is no percentage above 0, the release is upright, or no protocol tried reaches the target.

    """
    if not 0.0 < target_percent < math.inf:
        raise AnalysisError(f'target {target_percent} %: give a percentage above 0')
    if release == 0.0:
        raise AnalysisError('a release at 0 rad: an upright rod does not swing, let it go at an angle')
    protocols = _protocols(_candidates(plant, release, fastest), plant, instruments, assumptions)
    bound = np.array([protocol.expected_percent for protocol in protocols])
    seconds = np.array([protocol.seconds for protocol in protocols])

    def promise(protocol: Plan) -> Promise:
        return Promise(
            plant=plant,
            instruments=instruments,
            assumptions=assumptions,
            release=release,
            speeds=protocol.speeds,
            swings=protocol.swings,
            repeats=protocol.repeats,
        )

    best: Plan | None = None
    aim = target_percent
    tried: set[Plan] = set()
    for _ in range(_AIMS):
        aim = max(aim, float(bound.min()))
        chosen = protocols[int(np.where(bound <= aim, seconds, math.inf).argmin())]
        if chosen in tried:
            break
        tried.add(chosen)
        expected = promise(chosen).half_width_percent
        if expected <= target_percent and (best is None or chosen.seconds < best.seconds):
            best = replace(chosen, expected_percent=expected)
        if _CLOSE * target_percent <= expected <= target_percent:
            break
        aim = min(aim * _CLOSER * target_percent / expected, _FARTHEST * target_percent)
    if best is None:
        most = promise(protocols[int(bound.argmin())])
        raise AnalysisError(
            f'{target_percent:g} % cannot be reached: limited by {most.limited_by}; '
            f'the best protocol tried comes to {most.half_width_percent:.2g} %'
        )
    return best


def _protocols(
    runs: Sequence[Sensitivity], plant: Plant, instruments: Instruments, assumptions: Assumptions
) -> list[Plan]:
    """Return those that can be carried out; what is expected of each is the least half width there can be."""
    prior = _prior_information(plant, assumptions)
    return [
        Plan(
            speeds=tuple(run.speed for run in chosen),
            swings=swings,
            repeats=repeats,
            expected_percent=100.0 * NORMAL_95 * math.sqrt(variance),
            seconds=sum(_SET_UP + repeats * (CATCH + (0.75 + swings) * run.period) for run in chosen),
        )
        for count in _RUNS
        for chosen in combinations(runs, count)
        for swings in _SWINGS
        if swings <= min(run.swings for run in chosen)
        for repeats, variance in zip(_REPEATS, _variances(chosen, instruments, swings, prior), strict=True)
    ]


def _prior_information(plant: Plant, assumptions: Assumptions) -> NDArray[np.float64]:
    """Return what is known beforehand of ln threshold, ln λ and c, as their spreads: those of the rods of the prior."""
    rods = rods_of_prior(Ruler(amplitude=plant.amplitude), assumptions, _RODS)
    spread = [float(np.std(rods.amplitude)) / plant.amplitude, float(np.sqrt(np.mean(rods.damping**2)))]
    return np.diag([0.0, *(max(each, FLOOR) ** -2 for each in spread)])


def _variances(
    runs: Sequence[Sensitivity], instruments: Instruments, swings: int, prior: NDArray[np.float64]
) -> list[float]:
    """Return that of ln threshold, for each number of repeats."""
    dial = dial_sigma(instruments.strobe)
    press = press_variance(instruments.stopwatch) / np.array(_REPEATS, dtype=np.float64) / swings**2
    information = np.tile(prior, (len(_REPEATS), 1, 1))
    for run in runs:
        gradient = run.gradient(swings)
        variance = press / run.period**2 + (run.of_speed * dial) ** 2 + FLOOR**2
        information += np.outer(gradient, gradient) / variance[:, None, None]
    found: list[float] = np.linalg.inv(information)[:, 0, 0].tolist()
    return found


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
