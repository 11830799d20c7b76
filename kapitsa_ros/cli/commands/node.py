"""`kapitsa node`."""

from __future__ import annotations

import os
import sys

import click

from kapitsa_ros.network.registry import NODE_NAMES
from kapitsa_ros.new_interpreter import run_by_new_interpreter
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.ros.arguments import COMPOSED, FOXGLOVE_SERVER


@click.command(context_settings={'ignore_unknown_options': True, 'allow_interspersed_args': False})
@click.argument('name', type=click.Choice((*NODE_NAMES, COMPOSED, FOXGLOVE_SERVER)))
@click.argument('arguments', nargs=-1, type=click.UNPROCESSED)
def node(*, name: str, arguments: tuple[str, ...]) -> None:
    """Run one node, as `ros2 run kapitsa_ros NAME` does; ARGUMENTS may hold --ros-args.

    `composed` runs several in one process: those whose names follow, or all of a rig. `foxglove_server` shows the rig
    or the replay in its domain to Foxglove.

    Without ROS_AUTOMATIC_DISCOVERY_RANGE in the environment it keeps to this machine.
    """
    with on_loopback():
        # In place of this process, so that signals and the exit status are the node's own.
        os.execv(sys.executable, run_by_new_interpreter('kapitsa_ros.nodes', name, *arguments))  # noqa: S606
