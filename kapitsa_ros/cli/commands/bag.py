"""`kapitsa bag`."""

from __future__ import annotations

from pathlib import Path

import click

from kapitsa_ros.cli.options import json_option, print_json
from kapitsa_ros.cli.terminal import say, show_table
from kapitsa_ros.reporting.bag_text import bag_conclusion, bag_table


@click.group(no_args_is_help=False)
def bag() -> None:
    """Look into a recorded run."""


@bag.command()
@click.argument('path', metavar='BAG', type=click.Path(path_type=Path))
@json_option
def info(*, path: Path, as_json: bool) -> None:
    """Say what is in a run: messages, simulated time, gaps, and whether it came to its end."""
    from kapitsa_ros.network.step_clock import SECOND  # noqa: PLC0415
    from kapitsa_ros.recording.reader import RunBag  # noqa: PLC0415

    opened = RunBag(path)
    motion = opened.motion
    values = {
        'messages': opened.messages,
        'duration_s': (opened.last_stamp_ns - opened.first_stamp_ns) / SECOND,
        'complete': opened.complete,
        'gaps': motion.gaps,
        'lost_s': motion.lost,
        'first_stamp_s': opened.first_stamp_ns / SECOND,
        'last_stamp_s': opened.last_stamp_ns / SECOND,
    }
    if as_json:
        print_json(values)
        return
    show_table(bag_table(values))
    say(bag_conclusion(values, opened.run, str(path)))
