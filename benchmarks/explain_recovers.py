"""How often `explain` names the true cause of synthetic readings, first or among those that cannot be told apart.

Each table has the three speeds of 1997, timed on an ideal rod with one cause at work, of a size drawn evenly from those
that `explain` tries and at which every run can be timed, and normal errors as large as the table states.
"""

from __future__ import annotations

import argparse
import os
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import numpy as np

from kapitsa_ros.analysis.explain import CAUSES, explain
from kapitsa_ros.analysis.table import Readings
from kapitsa_ros.configuration.tables import load_table
from kapitsa_ros.physics.plant import Plant

OF_1997, ROD = load_table('1997'), Plant()


def is_named(number: int, sigma: float, seed: int) -> bool:
    """Make one table of a cause, and tell whether the cause is named."""
    cause = CAUSES[number]
    rng = np.random.default_rng([number, seed])
    values = cause.values(ROD, OF_1997)
    while True:
        value = float(rng.choice(values) if cause.discrete else rng.uniform(values[0], values[-1]))
        periods = cause.periods(ROD, OF_1997.forcing, value)
        if np.isfinite(periods).all() and (periods > 5.0 * sigma).all():
            break
    noisy = periods + sigma * rng.standard_normal(periods.size)
    readings = Readings(OF_1997.forcing, noisy, np.zeros_like(noisy), np.full_like(noisy, sigma))
    found = explain(readings, ROD)
    return cause.name in (found.explanations[0].name, *found.indistinguishable)


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--tables', type=int, default=50, help='of each cause')
    parser.add_argument('--sigma', type=float, default=0.02, help='error of a period, s')
    parser.add_argument('--processes', type=int, default=len(os.sched_getaffinity(0)))
    options = parser.parse_args()
    with ProcessPoolExecutor(options.processes) as pool:
        for index, each in enumerate(CAUSES):
            named = list(pool.map(partial(is_named, index, options.sigma), range(options.tables), chunksize=5))
            print(f'{each.name:30} {sum(named):3} of {options.tables} ({100.0 * np.mean(named):.0f} %)', flush=True)
