"""`kapitsa campaign`: many virtual experiments."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import click
from rich.console import Console
from rich.progress import track

from kapitsa_ros._api.campaign import campaign as call
from kapitsa_ros.cli.options import instrument_options, json_option, plant_options, print_json
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.laboratory.campaign import Campaign
    from kapitsa_ros.physics.plant import Plant


@click.command()
@click.option('--experiments', type=click.IntRange(1), required=True, help='how many, with the seeds 1, 2, 3...')
@click.option('--protocol', default='1997', show_default=True, help='name of a shipped protocol, or a YAML file')
@click.option('--scheduler', metavar='ADDR', help='of a Dask cluster; without it all cores of this machine compute')
@plant_options
@instrument_options
@json_option
def campaign(
    *, experiments: int, protocol: str, scheduler: str | None, plant: Plant, instruments: Instruments, as_json: bool
) -> None:
    """Carry out many whole experiments in process, and count how often their intervals tell the truth."""
    result = call(
        plant,
        experiments=experiments,
        instruments=instruments,
        protocol=protocol,
        scheduler=scheduler,
        progress=lambda stream: track(stream, 'experiments', experiments, console=Console(stderr=True), transient=True),
    )
    found = result.summary
    if as_json:
        print_json(_values(found) | {'wall_s': result.wall, 'efficiency': result.efficiency})
        return
    median, low, high = (speed / RPM for speed in found.omega_crit)
    truth = result.truth / RPM
    click.echo(f'{found.experiments} experiments, {found.failed} without a critical speed, {result.wall:.1f} s')
    if found.failed == found.experiments:
        speeds = ', '.join(f'{speed / RPM:.0f}' for speed in load_protocol(protocol).speeds)
        click.echo(f'no swing could be timed at {speeds} RPM; the critical speed of this plant is {truth:.1f} RPM')
        return
    width = 'unbounded' if math.isnan(found.width) else f'{found.width / RPM:.1f} RPM'
    click.echo(f'omega_crit          {median:.1f} RPM (16 to 84 %: {low:.1f} to {high:.1f}); truth {truth:.1f}')
    click.echo(f'95 % intervals hold the truth in {100 * found.coverage:.1f} %; median width {width}')
    click.echo(f'unbounded intervals {found.unbounded}')


def _values(found: Campaign) -> dict[str, Any]:
    median, low, high = (speed / RPM for speed in found.omega_crit)
    return {
        'experiments': found.experiments,
        'failed': found.failed,
        'omega_crit_rpm': {'median': median, 'p16': low, 'p84': high},
        'coverage95': found.coverage,
        'interval_width_rpm': {'median': found.width / RPM},
        'unbounded': found.unbounded,
    }
