"""`kapitsa urdf`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from kapitsa_ros.cli.options import plant_options
from kapitsa_ros.configuration.urdf import urdf as description

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant


@click.command()
@plant_options
def urdf(*, plant: Plant) -> None:
    """Print the URDF of jigsaw and pendulum, for RViz and other viewers: its joints are those of /joint_states."""
    click.echo(description(plant), nl=False)
