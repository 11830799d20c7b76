"""`kapitsa figures`: Figures 2 to 6 of the report, recomputed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from kapitsa_ros._api.figures import figures as call
from kapitsa_ros.cli.options import SPEED, json_option, overwrite_option, plant_options, print_json
from kapitsa_ros.cli.progress import shown_stages

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant


@click.command()
@plant_options
@click.option('--speed', type=SPEED, default=2500, show_default=True, help='forcing speed of Figures 4 and 5')
@click.option(
    '--output',
    type=click.Path(path_type=Path),
    default='figures',
    show_default=True,
    help='a folder, or a file such as figure.svg, whose name gets the number of each figure',
)
@overwrite_option
@click.option(
    '--format',
    'kind',
    type=click.Choice(['png', 'svg', 'pdf']),
    help='of the files  [default: by the suffix of --output, else png]',
)
@json_option
def figures(plant: Plant, speed: float, output: Path, kind: str | None, *, overwrite: bool, as_json: bool) -> None:
    """Draw Figures 2 to 6 of the report, for a rod, with the readings of 1997."""
    with shown_stages() as on_progress:
        drawn = call(plant, output, speed=speed, format=kind, overwrite=overwrite, on_progress=on_progress)
    files = [str(file) for file in drawn.files]
    if as_json:
        print_json({'figures': files})
    else:
        click.echo('\n'.join(files))
