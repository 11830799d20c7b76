"""`kapitsa urdf`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from kapitsa_ros.rig.description import urdf as description
from kapitsa_ros.rig.options import plant_options

if TYPE_CHECKING:
    from kapitsa_ros.physics.parameters import PlantParameters


@click.command()
@plant_options
def urdf(*, plant: PlantParameters) -> None:
    """Print the URDF of jigsaw and pendulum, for RViz and other viewers: its joints are those of /joint_states."""
    click.echo(description(plant), nl=False)
