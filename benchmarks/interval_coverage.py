"""How often 95 % intervals hold the truth, for rods and mistakes of many kinds, and how wide they are.

For each kind of experiment: the share of intervals that hold the exact threshold of the plant, the two-sided 99 % range
of that share (Clopper and Pearson), the median width, that over the width of a fit that is told which effects are there
but not how large they are, the share of its intervals that hold, and the share of intervals that are unbounded.
"""

from __future__ import annotations

import argparse
import math
import os
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.assumptions import DEFAULT_ASSUMPTIONS, Assumptions
from kapitsa_ros.analysis.critical_speed import fit_timings, ruler_of
from kapitsa_ros.analysis.share_range import share_range
from kapitsa_ros.analysis.timing_row import timing_rows
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.play import omega_crit_with_play
from kapitsa_ros.units import RPM, is_within

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kapitsa_ros.network.run import Run

SPEEDS = {2: (2240.0, 2780.0), 3: (2240.0, 2640.0, 2780.0), 8: tuple(np.linspace(1700.0, 3000.0, 8).tolist())}
EXPECTED = (0.93, 0.98)
NONE = {
    'play_probability': 0.0,
    'heavy_damping_probability': 0.0,
    'coulomb_probability': 0.0,
    'miscount_probability': 0.0,
}
"""What is told of a rod and a person without any effect."""


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A kind of experiment."""

    speeds: tuple[float, ...]
    """RPM."""
    plant: Plant | None = None
    """None: each experiment has a rod of its own, drawn from what the interval assumes of rods."""
    sweep: bool = False
    miscount: float = 0.0
    rate_u: float = 0.0
    """Standard deviation of the stopwatch's rate, of which the analyst is told."""
    told: Mapping[str, float] = field(default_factory=dict)
    """Assumptions of an analyst who knows which effects are there."""
    fooled: bool = False
    """Only experiments whose strobe showed an alias."""


@dataclass(frozen=True, kw_only=True)
class Result:
    """What an experiment gave."""

    truth: float
    """Exact threshold of the rod, rad/s."""
    interval: tuple[float | None, float | None]
    told_interval: tuple[float | None, float | None]


def kinds() -> dict[str, Kind]:
    """Return every kind, by its name."""
    rod = Plant()
    played = {'play_probability': 1.0}
    sticks = {'coulomb_probability': 1.0}
    named: dict[str, Kind] = {}
    for preset, told in (('ideal', {}), ('bearing', sticks), ('as_built_1997', played | sticks)):
        plant = load_preset(preset)
        for number, speeds in SPEEDS.items():
            named[f'{preset}, {number} speeds'] = Kind(plant=plant, speeds=speeds, told=told)
        named[f'{preset}, sweep of 3'] = Kind(plant=plant, speeds=SPEEDS[3], sweep=True, told=told)
        named[f'{preset}, strobe fooled, 3 speeds'] = Kind(plant=plant, speeds=SPEEDS[3], told=told, fooled=True)
    for number in (3, 8):
        for name, plant, told in (
            ('Coulomb 3 rad/s²', replace(rod, coulomb=3.0), sticks),
            ('play 0.5 mm', replace(rod, clearance=0.5e-3), played),
            ('play 2 mm', replace(rod, clearance=2e-3), played),
            ('damping 5 1/s', replace(rod, damping=5.0), {'heavy_damping_probability': 1.0}),
        ):
            named[f'{name}, {number} speeds'] = Kind(plant=plant, speeds=SPEEDS[number], told=told)
        named[f'miscount in 10 %, {number} speeds'] = Kind(
            plant=rod, speeds=SPEEDS[number], miscount=0.1, told={'miscount_probability': 0.1}
        )
        named[f'rods drawn from the priors, {number} speeds'] = Kind(
            speeds=SPEEDS[number],
            miscount=DEFAULT_ASSUMPTIONS.miscount_probability,
            told={name: getattr(DEFAULT_ASSUMPTIONS, name) for name in NONE},
        )
        named[f'stopwatch of u = 2 %, {number} speeds'] = Kind(plant=rod, speeds=SPEEDS[number], rate_u=0.02)
    return named


def drawn_rod(seed: int) -> Plant:
    """Return a rod as `DEFAULT_ASSUMPTIONS` has them, with an inertia factor from 0.6 to 1."""
    rng, assumed = np.random.default_rng([seed, 78]), DEFAULT_ASSUMPTIONS
    heavy, played, sticks = rng.random(3) < (
        assumed.heavy_damping_probability, assumed.play_probability, assumed.coulomb_probability
    )  # fmt: skip
    light, share, play = abs(rng.standard_normal()), *rng.random(2)
    return Plant(
        inertia_factor=float(rng.uniform(0.6, 1.0)),
        damping=float(assumed.heavy_damping_limit * share if heavy else assumed.light_damping * light),
        clearance=float(assumed.play_limit * play if played else 0.0),
        coulomb=float(assumed.coulomb_scale * abs(rng.standard_cauchy()) if sticks else 0.0),
    )


def perform(kind: Kind, seed: int) -> Result | None:
    """Carry out one experiment; None where the strobe was to be fooled and was not, or nothing was timed."""
    overrides = {
        'miscount_probability': kind.miscount,
        'rate_error': kind.rate_u * float(np.random.default_rng([seed, 77]).standard_normal()),
    }
    plant = kind.plant or drawn_rod(seed)
    protocol = replace(load_protocol('1997'), speeds=tuple(speed * RPM for speed in kind.speeds), sweep=kind.sweep)
    runs = SimulatedExperiment(
        plant=plant, instruments=load_instruments('1997', overrides), protocol=protocol, seed=seed
    ).runs()
    if kind.fooled and all(row.alias is None for row in timing_rows(runs)):
        return None
    stated = Assumptions(stopwatch_rate_u=kind.rate_u)
    blind = _interval(runs, plant.gravity, stated)
    told = _interval(runs, plant.gravity, replace(stated, **(NONE | dict(kind.told))))
    if blind is None or told is None:
        return None
    return Result(truth=omega_crit_with_play(plant), interval=blind, told_interval=told)


def _interval(runs: list[Run], gravity: float, assumptions: Assumptions) -> tuple[float | None, float | None] | None:
    best = fit_timings(timing_rows(runs), ruler_of(runs[0]), gravity, assumptions).best
    return None if best is None else best.interval


def summary(results: Iterable[Result]) -> str:
    """Return one line of the table."""
    every = list(results)
    number = len(every)
    held = sum(is_within(each.truth, each.interval) for each in every)
    told_held = sum(is_within(each.truth, each.told_interval) for each in every)
    low, high = share_range(held, number, 0.99)
    width, told = (_median_width([getattr(each, name) for each in every]) for name in ('interval', 'told_interval'))
    unbounded = sum(None in each.interval for each in every) / number
    good = low <= EXPECTED[1] and high >= EXPECTED[0]
    return (
        f'{number:5} {100 * held / number:6.1f} {100 * low:6.1f} {100 * high:5.1f} {"yes" if good else "NO":>4} '
        f'{width:8.1f} {width / told:6.2f} {100 * told_held / number:6.1f} {100 * unbounded:6.1f}'
    )


def _median_width(intervals: Iterable[tuple[float | None, float | None]]) -> float:
    return float(np.median([math.inf if low is None or high is None else high - low for low, high in intervals])) / RPM


def main() -> None:
    """Print a row a kind as it is done."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--experiments', type=int, default=1000, help='of each kind')
    parser.add_argument('--processes', type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument('--only', default='', help='kinds whose name holds this')
    options = parser.parse_args()
    print(f'{"":36} {"n":>5} {"held %":>6} {"from":>6} {"to":>5} {"good":>4} {"RPM":>8} ', end='')
    print(f'{"told":>6} {"held":>6} {"open %":>6}')
    with ProcessPoolExecutor(options.processes) as pool:
        for name, kind in kinds().items():
            if options.only not in name:
                continue
            found: list[Result] = []
            seed = 1
            while len(found) < options.experiments:
                seeds = range(seed, seed + 4 * options.processes)
                found += [each for each in pool.map(partial(perform, kind), seeds, chunksize=2) if each is not None]
                seed = seeds.stop
            print(f'{name:36} {summary(found[: options.experiments])}', flush=True)


if __name__ == '__main__':
    main()
