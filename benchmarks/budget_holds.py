"""The uncertainty budget against Monte Carlo of the same model, for each preset and number of speeds.

Prints the combined standard uncertainty by the law of propagation, that of the draws, their ratio, and whether the
budget calls the model linear: where it does, the two agree within 5 %, else it says to take the draws'.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

from kapitsa_ros.analysis.experiment import budget_of
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.units import RPM

PRESETS = ('ideal', 'bearing', 'as_built_1997')
SPEEDS = {2: (2240.0, 2780.0), 3: (2240.0, 2640.0, 2780.0), 8: tuple(np.linspace(1700.0, 3000.0, 8).tolist())}

if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--experiments', type=int, default=5, help='of each kind')
    options = parser.parse_args()
    for preset in PRESETS:
        for number, speeds in SPEEDS.items():
            protocol = replace(load_protocol('1997'), speeds=tuple(speed * RPM for speed in speeds))
            for seed in range(1, options.experiments + 1):
                experiment = SimulatedExperiment(
                    plant=load_preset(preset), instruments=load_instruments('1997'), protocol=protocol, seed=seed
                )
                found = budget_of(experiment.runs())
                ratio = found.u / found.monte_carlo_u
                linear = 'linear' if found.is_linear else 'not linear: Monte Carlo is given'
                print(
                    f'{preset:14} {number} speeds, seed {seed}: u_c {found.u / RPM:6.2f} RPM, Monte Carlo '
                    f'{found.monte_carlo_u / RPM:6.2f} RPM, ratio {ratio:.3f}, {linear}',
                    flush=True,
                )
