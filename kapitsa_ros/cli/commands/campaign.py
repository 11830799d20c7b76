"""`kapitsa campaign`: many virtual experiments."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click
from rich.console import Console
from rich.progress import track

from kapitsa_ros._api.campaign import campaign as call
from kapitsa_ros.cli.options import assumption_option, instrument_options, json_option, plant_options, print_json
from kapitsa_ros.cli.terminal import say, show_table
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.reporting.campaign_text import campaign_conclusion, campaign_table
from kapitsa_ros.reporting.plant_sentence import plant_sentence
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from kapitsa_ros.analysis.critical_speed.assumptions import Assumptions
    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.laboratory.campaign import Campaign
    from kapitsa_ros.physics.plant import Plant


@click.command()
@click.option('--experiments', type=click.IntRange(1), required=True, help='how many, with the seeds 1, 2, 3...')
@click.option('--protocol', default='1997', show_default=True, help='name of a shipped protocol, or a YAML file')
@click.option('--scheduler', metavar='ADDR', help='of a Dask cluster; without it all cores of this machine compute')
@plant_options
@instrument_options
@assumption_option
@json_option
def campaign(
    *,
    experiments: int,
    protocol: str,
    scheduler: str | None,
    plant: Plant,
    instruments: Instruments,
    assumptions: Assumptions,
    as_json: bool,
) -> None:
    """Carry out many whole experiments in process, and count how often their intervals tell the truth."""
    result = call(
        plant,
        experiments=experiments,
        instruments=instruments,
        protocol=protocol,
        scheduler=scheduler,
        assumptions=assumptions,
        progress=lambda stream: track(stream, 'experiments', experiments, console=Console(stderr=True), transient=True),
    )
    found = result.summary
    if as_json:
        print_json(_values(found) | {'wall_s': result.wall, 'efficiency': result.efficiency})
        return
    speeds = [f'{speed / RPM:.0f}' for speed in load_protocol(protocol).speeds]
    say([f'{plant_sentence(plant)}. {found.experiments} experiments at {", ".join(speeds)} RPM, {result.wall:.1f} s.'])
    if found.failed < found.experiments:
        show_table(campaign_table(found, result.truth))
    say(campaign_conclusion(found, result.truth, asdict(result.assumptions), speeds))


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
