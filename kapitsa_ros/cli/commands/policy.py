"""`kapitsa policy`."""

from __future__ import annotations

import click

from kapitsa_ros.rig.sros2_policy import policy as text_of


@click.command()
@click.option('--namespace', default='/', show_default=True, help='of the nodes')
def policy(*, namespace: str) -> None:
    """Print the SROS2 policy of the eight roles: what each may publish, hear and answer.

    It is for `ros2 security create_permission`; enclaves are /kapitsa_ros/ROLE. The Fast DDS of the wheels has no
    security plugins: to use it takes a ROS installation.
    """
    click.echo(text_of(namespace), nl=False)
