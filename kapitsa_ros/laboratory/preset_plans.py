"""The cheapest protocol for each preset: planned once with the instruments of 1997 and shipped, as reports need it.

They depend on nothing that a user records. `python -m kapitsa_ros.laboratory.preset_plans` plans anew.
"""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.plan import Plan, cheapest_plan
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.laboratory.preset_trials import trial_plants
from kapitsa_ros.output_file import replacing
from kapitsa_ros.resources import resource_path
from kapitsa_ros.units import RPM, in_rpm

if TYPE_CHECKING:
    from pathlib import Path

    from kapitsa_ros.physics.plant import Plant

TARGET_PERCENT = 3.0

_COLUMNS = ('plant', 'speeds_rpm', 'swings', 'repeats', 'expected_percent', 'seconds')


def plan_with_1997(plant: Plant) -> Plan | None:
    """Return the cheapest protocol with the instruments of 1997; None where none reaches the target."""
    try:
        return cheapest_plan(plant, load_instruments('1997'), TARGET_PERCENT)
    except AnalysisError:
        return None


def shipped_path() -> Path:
    """Return the file of the shipped plans."""
    return resource_path('config', 'report', 'preset_plans.csv')


def shipped_plans() -> dict[Plant, Plan | None]:
    """Return the plans that are shipped, by their plant; None where the target cannot be reached."""
    plants = trial_plants()
    with shipped_path().open(encoding='utf-8', newline='') as file:
        return {plants[row['plant']]: _plan(row) for row in csv.DictReader(file)}


def write_plans(path: Path) -> None:
    """Plan for each plant of the trials and write what came of it."""
    with replacing(path) as draft, draft.open('w', encoding='utf-8', newline='') as file:
        writer = csv.writer(file, lineterminator='\n')
        writer.writerow(_COLUMNS)
        for name, plant in trial_plants().items():
            plan = plan_with_1997(plant)
            writer.writerow([name, *([''] * (len(_COLUMNS) - 1) if plan is None else _cells(plan))])


def _plan(row: dict[str, str]) -> Plan | None:
    if not row['swings']:
        return None
    return Plan(
        speeds=tuple(float(speed) * RPM for speed in row['speeds_rpm'].split()),
        swings=int(row['swings']),
        repeats=int(row['repeats']),
        expected_percent=float(row['expected_percent']),
        seconds=float(row['seconds']),
    )


def _cells(plan: Plan) -> list[str]:
    speeds = ' '.join(f'{in_rpm(speed):.6f}' for speed in plan.speeds)
    return [speeds, str(plan.swings), str(plan.repeats), f'{plan.expected_percent:.6f}', f'{plan.seconds:.6f}']


if __name__ == '__main__':
    write_plans(shipped_path())
