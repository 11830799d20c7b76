"""`kapitsa replay`."""

from __future__ import annotations

from pathlib import Path

import click
from rich.console import Console

from kapitsa_ros.cli.options import json_option, print_json, rate_option


@click.command()
@click.argument('bags', nargs=-1, required=True, type=click.Path(path_type=Path))
@rate_option
@json_option
def replay(*, bags: tuple[Path, ...], rate: float, as_json: bool) -> None:
    """Play recorded runs through the graph; the analyser there analyses them as they come."""
    from kapitsa_ros.cli.progress import shown_progress  # noqa: PLC0415
    from kapitsa_ros.recording.reader import RunBag  # noqa: PLC0415
    from kapitsa_ros.reporting.report_tables import report_tables  # noqa: PLC0415
    from kapitsa_ros.rig.session import replay_bags  # noqa: PLC0415  # rclpy takes its time

    with shown_progress(len(bags)) as on_progress:
        values = replay_bags(bags, rate, on_progress)
    if as_json:
        print_json(values)
        return
    console = Console()
    for table in report_tables(values, RunBag(bags[0]).run.plant):
        console.print(table)
