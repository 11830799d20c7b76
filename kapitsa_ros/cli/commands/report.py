"""`kapitsa report`: one file about recorded runs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.core import ParameterSource

from kapitsa_ros.cli.options import assumption_option, json_option, overwrite_option, print_json
from kapitsa_ros.cli.warnings_of_bags import warn

if TYPE_CHECKING:
    from kapitsa_ros.analysis.assumptions import Assumptions


@click.command()
@click.argument('bags', nargs=-1, type=click.Path(path_type=Path))
@click.option(
    '--campaign',
    type=click.Path(path_type=Path, dir_okay=False),
    help='instead of runs: the outcomes that `kapitsa campaign --output` has written',
)
@click.option('--output', type=click.Path(path_type=Path, dir_okay=False), required=True, help='the file to write')
@overwrite_option
@click.option(
    '--format',
    'kind',
    type=click.Choice(['html', 'md', 'pdf']),
    help='of the file  [default: by its suffix, else html]',
)
@click.option('--budget', is_flag=True, expose_value=False, hidden=True)  # of scripts: it is always in the report
@assumption_option
@json_option
def report(
    *,
    bags: tuple[Path, ...],
    campaign: Path | None,
    output: Path,
    overwrite: bool,
    kind: str | None,
    assumptions: Assumptions,
    as_json: bool,
) -> None:
    """Write a report on recorded runs: tables and figures beside 1997, uncertainty, causes, a plan, a discussion.

    Or on a campaign: how often intervals hold, and how far estimates deviate, by what was varied.
    """
    if bool(bags) == bool(campaign):
        raise click.UsageError('give the runs, BAGS, or --campaign FILE')
    typed = click.get_current_context().get_parameter_source('assumed')
    if campaign is not None and typed is ParameterSource.COMMANDLINE:
        raise click.UsageError('--assume has no effect on --campaign: its intervals are there already')
    from kapitsa_ros._api.campaign_report import campaign_report  # noqa: PLC0415
    from kapitsa_ros._api.report import report as call  # noqa: PLC0415
    from kapitsa_ros.cli.progress import shown_stages  # noqa: PLC0415

    warnings: tuple[str, ...] = ()
    with shown_stages() as on_progress:
        if campaign is not None:
            campaign_report(campaign, output, format=kind, overwrite=overwrite)
        else:
            warnings = call(
                bags, output, assumptions=assumptions, format=kind, overwrite=overwrite, on_progress=on_progress
            ).warnings
    for warning in warnings:
        warn(warning)
    if as_json:
        print_json({'output': str(output)})
    else:
        click.echo(f'{output}')
