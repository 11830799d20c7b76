"""`kapitsa analyse`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from kapitsa_ros.analysis.slow_frequency import DEFAULT_ESTIMATOR, ESTIMATORS
from kapitsa_ros.analysis.timing_row import timing_rows
from kapitsa_ros.cli.options import (
    SPEED,
    assumption_option,
    bags_argument,
    budget_option,
    json_option,
    overwrite_option,
    plant_options,
)
from kapitsa_ros.cli.progress import shown_stages
from kapitsa_ros.cli.show_result import show_result
from kapitsa_ros.cli.warnings_of_bags import warn_of_defects, warn_of_repeats
from kapitsa_ros.configuration.tables import write_timings
from kapitsa_ros.errors import OPTION
from kapitsa_ros.output_file import check_output
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.schema import describe
from kapitsa_ros.units import counted

if TYPE_CHECKING:
    from kapitsa_ros.analysis.assumptions import Assumptions


@click.command()
@bags_argument
@click.option('--blind/--motion', default=True, show_default=True, help='from the readings, or from θ(t)')
@click.option(
    '--estimator',
    type=click.Choice(list(ESTIMATORS)),
    help=f'of the slow frequency, with --motion  [default: {DEFAULT_ESTIMATOR}]',
)
@click.option(
    '--joint',
    help="name of a joint in others' bags: its position (sensor_msgs/JointState) is θ; "
    'TOPIC:NAME where several topics have it',
)
@click.option(
    '--speed', 'speeds', type=SPEED, multiple=True, help='of the shaft, RPM, with --joint: one for each bag, in order'
)
@click.option('--table', type=click.Path(path_type=Path), help='CSV file for the timings, as `kapitsa reduce` takes it')
@overwrite_option
@plant_options
@assumption_option
@budget_option
@json_option
@click.pass_context
def analyse(
    context: click.Context,
    *,
    bags: tuple[Path, ...],
    blind: bool,
    estimator: str | None,
    joint: str | None,
    speeds: tuple[float, ...],
    table: Path | None,
    overwrite: bool,
    plant: Plant,
    assumptions: Assumptions,
    with_budget: bool,
    as_json: bool,
) -> None:
    """Analyse recorded runs from what was read and commanded, without the graph.

    The plant is what the bags say; its options are for --joint.
    """
    from kapitsa_ros.laboratory.bag_analysis import analyse_bags, analyse_motions  # noqa: PLC0415
    from kapitsa_ros.laboratory.joint_analysis import analyse_joints  # noqa: PLC0415
    from kapitsa_ros.recording.reader import runs_of  # noqa: PLC0415

    blind = blind and joint is None
    _refuse_idle_options(context, joint)
    if blind and estimator is not None:
        raise UsageError(
            f'{OPTION}: a blind analysis takes the readings: give --motion too', option='estimator', value=estimator
        )
    if with_budget and not blind:
        raise UsageError(f'{OPTION}: a budget is of what was read: leave --motion out', option='budget', value=True)
    if table is not None:
        check_output(table, 'table', overwrite=overwrite)
    warn_of_repeats(bags)
    with shown_stages(f'reading and fitting {counted(len(bags), "run")}'):
        if joint is not None:
            values = analyse_joints(
                bags, joint, speeds, plant, estimator=estimator or DEFAULT_ESTIMATOR, assumptions=assumptions
            )
        elif blind:
            values = analyse_bags(bags, assumptions, with_budget=with_budget)
        else:
            values = analyse_motions(bags, estimator or DEFAULT_ESTIMATOR, assumptions)
        if table is not None:
            write_timings(table, timing_rows([bag.run for bag in runs_of(bags)], assumptions.dial_u))
    warn_of_defects(values['runs'])
    show_result(values, Plant(**values['plant']), as_json=as_json)


def _refuse_idle_options(context: click.Context, joint: str | None) -> None:
    """Refuse options that would change nothing."""
    given = {
        name for name in context.params if context.get_parameter_source(name) is click.core.ParameterSource.COMMANDLINE
    }
    idle = {'table'} if joint is not None else {'speeds', 'preset', *(item.name for item in describe(Plant))}
    for name in sorted(given & idle):
        option = name.replace('speeds', 'speed').replace('_', '-')
        why = 'a motion has no timings' if joint is not None else 'bags of the rig say it themselves; it is for --joint'
        raise UsageError(f'{OPTION}: {why}', option=option)
    if joint is not None and not context.params['speeds']:
        raise UsageError(f'{OPTION} is needed with --joint: how fast the shaft turned', option='speed')
