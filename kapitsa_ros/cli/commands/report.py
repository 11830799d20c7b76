"""`kapitsa report`: one file about recorded runs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from kapitsa_ros.cli.options import assumption_option, bags_argument, json_option, overwrite_option
from kapitsa_ros.cli.warnings_of_bags import warn

if TYPE_CHECKING:
    from kapitsa_ros.analysis.critical_speed.assumptions import Assumptions


@click.command()
@bags_argument
@click.option('--output', type=click.Path(path_type=Path, dir_okay=False), required=True, help='the file to write')
@overwrite_option
@click.option(
    '--format',
    'kind',
    type=click.Choice(['html', 'md', 'pdf']),
    help='of the file  [default: by its suffix, else html]',
)
@assumption_option
@json_option
def report(
    *,
    bags: tuple[Path, ...],
    output: Path,
    overwrite: bool,
    kind: str | None,
    assumptions: Assumptions,
    as_json: bool,
) -> None:
    """Write a report on recorded runs: tables and figures beside 1997, uncertainty, causes, a plan, a discussion."""
    from kapitsa_ros._api.report import report as call  # noqa: PLC0415
    from kapitsa_ros.cli.options import print_json  # noqa: PLC0415
    from kapitsa_ros.cli.progress import shown_stages  # noqa: PLC0415

    with shown_stages() as on_progress:
        written = call(bags, output, assumptions=assumptions, format=kind, overwrite=overwrite, on_progress=on_progress)
    for warning in written.warnings:
        warn(warning)
    if as_json:
        print_json({'output': str(output)})
    else:
        click.echo(f'{output}')
