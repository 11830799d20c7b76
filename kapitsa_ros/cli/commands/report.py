"""`kapitsa report`: one self-contained page about recorded runs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from kapitsa_ros.cli.options import assumption_option, json_option, warn_of_repeats

if TYPE_CHECKING:
    from kapitsa_ros.analysis.critical_speed.assumptions import Assumptions


@click.command()
@click.argument('bags', nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option('--output', type=click.Path(path_type=Path, dir_okay=False), required=True, help='the HTML file to write')
@assumption_option
@json_option
def report(*, bags: tuple[Path, ...], output: Path, assumptions: Assumptions, as_json: bool) -> None:
    """Write a report on recorded runs: Tables 1 to 3 and Figures 2 to 6 beside 1997, the explanation, and a plan."""
    warn_of_repeats(bags)
    from kapitsa_ros._api.report import report as call  # noqa: PLC0415
    from kapitsa_ros.cli.options import print_json  # noqa: PLC0415

    call(bags, output, assumptions=assumptions)
    if as_json:
        print_json({'output': str(output)})
    else:
        click.echo(f'{output}')
