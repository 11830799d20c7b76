"""`kapitsa analyse`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from kapitsa_ros.analysis.slow_frequency import DEFAULT_ESTIMATOR, ESTIMATORS
from kapitsa_ros.analysis.timing_row import timing_rows
from kapitsa_ros.cli.options import assumption_option, bags_argument, budget_option, json_option
from kapitsa_ros.cli.progress import shown_stages
from kapitsa_ros.cli.show_result import show_result
from kapitsa_ros.cli.warnings_of_bags import warn_of_defects, warn_of_repeats
from kapitsa_ros.configuration.tables import write_timings
from kapitsa_ros.errors import OPTION
from kapitsa_ros.output_file import check_output
from kapitsa_ros.rig.errors import UsageError

if TYPE_CHECKING:
    from kapitsa_ros.analysis.critical_speed.assumptions import Assumptions


@click.command()
@bags_argument
@click.option('--blind/--motion', default=True, show_default=True, help='from the readings, or from θ(t)')
@click.option(
    '--estimator',
    type=click.Choice(list(ESTIMATORS)),
    help=f'of the slow frequency, with --motion  [default: {DEFAULT_ESTIMATOR}]',
)
@click.option('--table', type=click.Path(path_type=Path), help='CSV file for the timings, as `kapitsa reduce` takes it')
@assumption_option
@budget_option
@json_option
def analyse(
    *,
    bags: tuple[Path, ...],
    blind: bool,
    estimator: str | None,
    table: Path | None,
    assumptions: Assumptions,
    with_budget: bool,
    as_json: bool,
) -> None:
    """Analyse recorded runs from what was read and commanded, without the graph."""
    from kapitsa_ros.laboratory.bag_analysis import analyse_bags, analyse_motions  # noqa: PLC0415
    from kapitsa_ros.recording.reader import runs_of  # noqa: PLC0415

    if blind and estimator is not None:
        raise UsageError(
            f'{OPTION}: a blind analysis takes the readings: give --motion too', option='estimator', value=estimator
        )
    if with_budget and not blind:
        raise UsageError(f'{OPTION}: a budget is of what was read: leave --motion out', option='budget', value=True)
    if table is not None:
        check_output(table, 'table')
    warn_of_repeats(bags)
    with shown_stages(f'reading and fitting {len(bags)} run(s)'):
        if blind:
            values = analyse_bags(bags, assumptions, with_budget=with_budget)
        else:
            values = analyse_motions(bags, estimator or DEFAULT_ESTIMATOR, assumptions)
        if table is not None:
            write_timings(table, timing_rows([bag.run for bag in runs_of(bags)], assumptions.dial_u))
        plant = runs_of(bags[:1])[0].run.plant
    warn_of_defects(values['runs'])
    show_result(values, plant, as_json=as_json)
