"""`kapitsa replay`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from kapitsa_ros.cli.options import bags_argument, json_option, rate_option
from kapitsa_ros.cli.show_result import show_result

if TYPE_CHECKING:
    from pathlib import Path


@click.command()
@bags_argument
@rate_option
@json_option
def replay(*, bags: tuple[Path, ...], rate: float, as_json: bool) -> None:
    """Play recorded runs through the graph; the analyser there analyses them as they come."""
    from kapitsa_ros.cli.progress import shown_progress  # noqa: PLC0415
    from kapitsa_ros.recording.reader import RunBag  # noqa: PLC0415
    from kapitsa_ros.rig.session import replay_bags  # noqa: PLC0415  # rclpy takes its time

    with shown_progress(len(bags)) as on_progress:
        values = replay_bags(bags, rate, on_progress)
    show_result(values, RunBag(bags[0]).run.plant, as_json=as_json)
