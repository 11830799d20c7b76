"""Whether experiments that carry out a plan get the interval that it promises.

For each preset and target: the protocol, half the width of the interval that is promised and the median of what is
reached, per cent of the critical speed; or what keeps the target from being reached.
"""

from __future__ import annotations

import argparse

import numpy as np

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.plan import cheapest_plan
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.laboratory.campaign import perform_all
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.operator.protocol import Protocol
from kapitsa_ros.physics.theory.play import omega_crit_with_play
from kapitsa_ros.units import RPM

PRESETS, TARGETS = ('ideal', 'bearing', 'as_built_1997'), (0.3, 1.0, 3.0, 10.0)


def row(preset: str, target: float, experiments: int) -> str:
    """Return one line of the table."""
    plant, instruments = load_preset(preset), load_instruments('1997')
    try:
        plan = cheapest_plan(plant, instruments, target)
    except AnalysisError as error:
        return str(error)
    protocol = Protocol(speeds=plan.speeds, swings=plan.swings, repeats=plan.repeats)
    experiment = SimulatedExperiment(plant=plant, instruments=instruments, protocol=protocol, seed=0)
    truth = omega_crit_with_play(plant)
    widths = [
        np.inf if low is None or high is None else 50.0 * (high - low) / truth
        for low, high in (outcome.interval for outcome in perform_all(experiment, experiments))
    ]
    reached = float(np.median(widths))
    speeds = ', '.join(f'{speed / RPM:.0f}' for speed in plan.speeds)
    return (
        f'{plan.expected_percent:.2f} % promised, {reached:.2f} % reached, ratio {reached / plan.expected_percent:.3f} '
        f'({speeds} RPM, {plan.repeats} of {plan.swings} swings, {plan.seconds:.0f} s)'
    )


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--experiments', type=int, default=300)
    options = parser.parse_args()
    for name in PRESETS:
        for aim in TARGETS:
            print(f'{name:15} {aim:4g} %: {row(name, aim, options.experiments)}', flush=True)
