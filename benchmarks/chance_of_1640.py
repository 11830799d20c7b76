"""How often an ideal plant, timed as in 1997, gives 1640 RPM or more: the figure of the report, by chance alone.

Prints one JSON object. `drawn` puts normal errors of 0.1 s on both presses of three swings at each of the three speeds;
`performed` has the whole procedure carried out by the virtual person, dial, display and all; `instruments_of_1997` does
so with the presses of the set `1997` as it is shipped.
"""

from __future__ import annotations

import argparse
import json
import math
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.line_fit import LineFit, fit_inverse_ols, fit_ols
from kapitsa_ros.analysis.table import Readings
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.laboratory.campaign import perform_all
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Callable

JITTER, SWINGS, LIMIT = 0.1, 3, 1640 * RPM
SPEEDS = np.array([2240.0, 2640.0, 2780.0]) * RPM


def share(values: list[float | None]) -> dict[str, float]:
    """Return median and spread (RPM), and how often the limit is reached: of all, and of those that gave a speed."""
    given = [value for value in values if value is not None]
    over = sum(value >= LIMIT for value in given)
    spread = dict(zip(('median', 'p16', 'p84'), np.quantile(given, (0.5, 0.16, 0.84)) / RPM, strict=True))
    return {name: float(value) for name, value in spread.items()} | {
        name: value
        for label, count in (('of_all', len(values)), ('of_given', len(given)))
        for name, value in (
            (label, over / count),
            (f'{label}_sigma', math.sqrt(over / count * (1 - over / count) / count)),
        )
    }


def critical(fit: Callable[[Readings], LineFit], readings: Readings) -> float | None:
    """Return the critical speed of a fit; None where the readings give none."""
    try:
        return fit(readings).omega_crit
    except AnalysisError:
        return None


def drawn(draws: int) -> dict[str, dict[str, float]]:
    """Put normal errors on the true periods."""
    periods = np.array([2 * math.pi / slow_frequency_nonlinear(Plant(), speed, 0.12) for speed in SPEEDS])
    rng = np.random.default_rng(1)
    sigma = JITTER * math.sqrt(2) / SWINGS
    found: dict[str, list[float | None]] = {'ordinary': [], 'inverse': []}
    for _ in range(draws):
        readings = Readings(SPEEDS, periods + sigma * rng.standard_normal(3), np.zeros(3), np.full(3, sigma))
        found['ordinary'].append(critical(fit_ols, readings))
        found['inverse'].append(critical(fit_inverse_ols, readings))
    return {name: share(values) for name, values in found.items()}


def performed(experiments: int, overrides: dict[str, float]) -> dict[str, dict[str, float]]:
    """Let the virtual person carry out the procedure."""
    instruments = load_instruments('1997', overrides)
    experiment = SimulatedExperiment(plant=Plant(), instruments=instruments, protocol=load_protocol('1997'), seed=0)
    outcomes = list(perform_all(experiment, experiments))
    return {
        'ordinary': share([outcome.ols for outcome in outcomes]),
        'inverse': share([outcome.inverse_ols for outcome in outcomes]),
    }


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--draws', type=int, default=20_000)
    parser.add_argument('--experiments', type=int, default=500)
    options = parser.parse_args()
    found = {
        'drawn': drawn(options.draws),
        'performed': performed(options.experiments, {'reaction_jitter': JITTER}),
        'instruments_of_1997': performed(options.experiments, {}),
    }
    print(json.dumps(found, indent=1))
