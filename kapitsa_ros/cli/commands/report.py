"""`kapitsa report`: one self-contained page about recorded runs."""

from __future__ import annotations

from pathlib import Path

import click

from kapitsa_ros.cli.options import warn_of_repeats
from kapitsa_ros.cli.output_files import check_output
from kapitsa_ros.replacement import replacing
from kapitsa_ros.rig.errors import RigError


@click.command()
@click.argument('bags', nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option('--output', type=click.Path(path_type=Path, dir_okay=False), required=True, help='the HTML file to write')
@click.option('--json', 'as_json', is_flag=True, help='print one JSON object on stdout')
def report(*, bags: tuple[Path, ...], output: Path, as_json: bool) -> None:
    """Write a report on recorded runs: Tables 1 to 3 and Figures 2 to 6 beside 1997, the explanation, and a plan."""
    check_output(output)
    warn_of_repeats(bags)
    try:
        import jinja2  # noqa: F401, PLC0415
        import matplotlib as mpl  # noqa: F401, PLC0415
    except ImportError as error:
        raise RigError(f'a report needs {error.name}: install kapitsa_ros[report]') from error
    from kapitsa_ros.cli.options import print_json  # noqa: PLC0415
    from kapitsa_ros.configuration.tables import load_table  # noqa: PLC0415
    from kapitsa_ros.recording.reader import RunBag  # noqa: PLC0415
    from kapitsa_ros.reporting.report import gather, render  # noqa: PLC0415

    runs = [RunBag(path).recorded for path in bags]
    page = render(gather(runs, load_table('1997')))
    with replacing(output) as draft:
        draft.write_text(page, encoding='utf-8')
    if as_json:
        print_json({'output': str(output)})
    else:
        click.echo(f'{output}')
