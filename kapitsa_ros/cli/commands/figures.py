"""`kapitsa figures`: Figures 2, 4, 5 and 6 of the report, recomputed."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from kapitsa_ros.cli.options import SPEED, json_option, plant_options, print_json
from kapitsa_ros.configuration.tables import load_table
from kapitsa_ros.errors import OPTION
from kapitsa_ros.output_file import replacing
from kapitsa_ros.rig.errors import UsageError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kapitsa_ros.physics.plant import Plant


@click.command()
@plant_options
@click.option('--speed', type=SPEED, default=2500, show_default=True, help='forcing speed of Figures 4 and 5')
@click.option('--output', type=click.Path(path_type=Path, file_okay=False), default='figures', show_default=True)
@json_option
def figures(plant: Plant, speed: float, output: Path, *, as_json: bool) -> None:
    """Draw Figures 2, 4, 5 and 6 of the report into a directory."""
    above = next(folder for folder in (output, *output.absolute().parents) if folder.exists())
    if not above.is_dir() or not os.access(above, os.W_OK | os.X_OK):
        raise UsageError(f'{OPTION}: cannot be made; give a folder you can write to', option='output', value=output)
    drawn = _draw(plant, speed)
    output.mkdir(parents=True, exist_ok=True)
    files = []
    for number, figure in drawn.items():
        file = output / f'figure_{number}.png'
        with replacing(file) as draft:
            figure.savefig(draft)
        files.append(str(file))
    if as_json:
        print_json({'figures': files})
    else:
        click.echo('\n'.join(files))


def _draw(plant: Plant, speed: float) -> dict[int, Figure]:
    try:
        from kapitsa_ros.reporting import figures as draw  # noqa: PLC0415  # matplotlib is an extra
    except ImportError as error:
        raise UsageError(
            f'figures need {error.name}: run `make setup`, or pip install "kapitsa_ros[report]"'
        ) from error
    table = load_table('1997')
    return {
        2: draw.stability_boundaries(plant, table.forcing.tolist()),
        4: draw.time_history(plant, speed),
        5: draw.power_spectrum(plant, speed),
        6: draw.frequency_sweep(plant, list(zip(table.forcing, table.slow, strict=True))),
    }
