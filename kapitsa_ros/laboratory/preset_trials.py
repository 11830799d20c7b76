"""What the procedure of 1997 makes of the presets: virtual experiments that were carried out once and are shipped.

They depend on nothing that a user records. `python -m kapitsa_ros.laboratory.preset_trials` carries them out anew.
"""

from __future__ import annotations

import csv
import math
from typing import TYPE_CHECKING

from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.laboratory.campaign import Outcome, perform_all
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.output_file import replacing
from kapitsa_ros.resources import resource_path
from kapitsa_ros.units import RPM, in_rpm

if TYPE_CHECKING:
    from pathlib import Path

    from kapitsa_ros.physics.plant import Plant

EXPERIMENTS = 40
"""For each plant."""

AS_BUILT_ON_BEARING = 'bearing, inertia as built'
"""Name of the trial in which only friction and play were mended."""

_COLUMNS = ('plant', 'seed', 'omega_crit_rpm', 'low_rpm', 'high_rpm', 'ols_rpm', 'inverse_rpm')
_DIGITS = 6


def trial_plants() -> dict[str, Plant]:
    """Return the presets, and the rod as built on the bearing: no bearing changes its inertia."""
    kappa = load_preset('as_built_1997').inertia_factor
    plants = {preset.replace('_', ' '): load_preset(preset) for preset in ('ideal', 'bearing', 'as_built_1997')}
    return plants | {AS_BUILT_ON_BEARING: load_preset('bearing', {'inertia_factor': kappa})}


def trial_experiment(plant: Plant) -> SimulatedExperiment:
    """Return the experiment of 1997 on a plant."""
    return SimulatedExperiment(
        plant=plant, instruments=load_instruments('1997'), protocol=load_protocol('1997'), seed=0
    )


def shipped_path() -> Path:
    """Return the file of the shipped outcomes."""
    return resource_path('config', 'report', 'preset_trials.csv')


def shipped_outcomes() -> dict[str, list[Outcome]]:
    """Return the outcomes that are shipped, by the plant's name, in the order of their seeds."""
    found: dict[str, list[Outcome]] = {}
    with shipped_path().open(encoding='utf-8', newline='') as file:
        for row in csv.DictReader(file):
            value, low, high, ols, inverse = (float(row[name]) * RPM if row[name] else None for name in _COLUMNS[2:])
            found.setdefault(row['plant'], []).append(
                Outcome(
                    seed=int(row['seed']),
                    omega_crit=value,
                    interval=(low, high),
                    ols=ols,
                    inverse_ols=inverse,
                    seconds=math.nan,
                )
            )
    return found


def write_outcomes(path: Path, experiments: int = EXPERIMENTS) -> None:
    """Carry out the experiments and write their outcomes."""
    with replacing(path) as draft, draft.open('w', encoding='utf-8', newline='') as file:
        writer = csv.writer(file, lineterminator='\n')
        writer.writerow(_COLUMNS)
        for name, plant in trial_plants().items():
            for each in perform_all(trial_experiment(plant), experiments):
                speeds = (each.omega_crit, *each.interval, each.ols, each.inverse_ols)
                rpm = map(in_rpm, speeds)
                writer.writerow([name, each.seed, *('' if speed is None else f'{speed:.{_DIGITS}f}' for speed in rpm)])


if __name__ == '__main__':
    write_outcomes(shipped_path())
