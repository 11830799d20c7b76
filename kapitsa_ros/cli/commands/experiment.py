"""`kapitsa experiment`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from kapitsa_ros._api.experiment import experiment as call
from kapitsa_ros.cli.options import (
    SEED,
    assumption_option,
    composed_option,
    instrument_options,
    json_option,
    plant_options,
    rate_option,
)
from kapitsa_ros.cli.show_result import show_result
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.recording.writer import COMPRESSIONS, STORAGES
from kapitsa_ros.units import counted

if TYPE_CHECKING:
    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.physics.plant import Plant


@click.command()
@plant_options
@instrument_options
@click.option('--seed', type=SEED, default=1, show_default=True, help='of all chance')
@click.option(
    '--bags', type=click.Path(path_type=Path), default=Path('runs'), show_default=True, help='folder for the runs'
)
@click.option('--protocol', default='1997', show_default=True, help='name of a shipped protocol, or a YAML file')
@rate_option
@click.option('--storage', type=click.Choice(STORAGES), default='mcap', show_default=True, help='of the bags')
@click.option(
    '--compression',
    type=click.Choice(tuple(COMPRESSIONS)),
    default='zstd',
    show_default=True,
    help='of the chunks in MCAP; none: larger files, read faster',
)
@composed_option
@assumption_option
@json_option
def experiment(
    *,
    plant: Plant,
    instruments: Instruments,
    seed: int,
    bags: Path,
    protocol: str,
    rate: float,
    storage: str,
    compression: str,
    composed: bool,
    assumptions: Assumptions,
    as_json: bool,
) -> None:
    """Run the laboratory: seven nodes carry out the protocol, each run is recorded to a bag, and all are reduced."""
    from kapitsa_ros.cli.foreign_output import foreign_output_on_stderr  # noqa: PLC0415
    from kapitsa_ros.cli.node_server import node_server  # noqa: PLC0415
    from kapitsa_ros.cli.progress import shown_progress  # noqa: PLC0415

    runs = len(load_protocol(protocol).runs)
    with node_server(), shown_progress(runs) as on_progress, foreign_output_on_stderr():
        found = call(
            plant,
            instruments=instruments,
            protocol=protocol,
            seed=seed,
            bags=bags,
            rate=rate,
            storage=storage,
            compression=compression,
            composed=composed,
            assumptions=assumptions,
            on_progress=on_progress,
        )
    show_result(found.values, plant, as_json=as_json)
    if not as_json:
        click.echo(f'{counted(len(found.bags), "run")} below {bags}; {found.realtime_factor:.0f} times real time')
        click.echo('Next:')
        click.echo(f'  kapitsa report {bags} --output report.html')
        click.echo(f'  kapitsa analyse {bags} --budget --table timings.csv')
        click.echo('  kapitsa explain timings.csv')
