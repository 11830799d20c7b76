"""`kapitsa bag`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kapitsa_ros.cli.options import bags_argument, json_option, overwrite_option, print_json
from kapitsa_ros.cli.progress import shown_stages
from kapitsa_ros.cli.terminal import say, show_table
from kapitsa_ros.cli.warnings_of_bags import warn
from kapitsa_ros.reporting.bag_text import bag_conclusion, bag_table

if TYPE_CHECKING:
    from kapitsa_ros.recording.reader import RunBag


@click.group(no_args_is_help=False)
def bag() -> None:
    """Look into recorded runs, make them whole, export them."""


@bag.command()
@click.argument('path', metavar='BAG', type=click.Path(path_type=Path))
@json_option
def info(*, path: Path, as_json: bool) -> None:
    """Say what is in a bag: messages, simulated time, gaps, and whether its bytes are those that were written."""
    from kapitsa_ros.recording.reader import open_runs  # noqa: PLC0415

    with shown_stages('reading'):
        runs = open_runs(path)
        values = [_values(run) for run in runs]
    if as_json:
        print_json(values[0] if len(values) == 1 else _together(values))
    else:
        for run, each in zip(runs, values, strict=True):
            show_table(bag_table(each))
            say(bag_conclusion(each, run.run, str(path), run.absent))
    for defect in dict.fromkeys(defect for run in runs for defect in run.defects):
        warn(f'{path}: {defect}')


@bag.command()
@bags_argument
@click.option('--output', type=click.Path(path_type=Path, file_okay=False), help='folder for the new bags')
@json_option
def recover(*, bags: tuple[Path, ...], output: Path | None, as_json: bool) -> None:
    """Make whole bags of what killed recorders have left; in place, or in a folder where that would lose something."""
    from kapitsa_ros.recording.recover import recover as call  # noqa: PLC0415

    found = []
    for path in bags:
        for made in call(path, output):
            found.append(made)
            for defect in made.defects:
                warn(f'{made.bag}: {defect}')
            if not as_json:
                click.echo(f'{made.bag}: {made.steps} steps, {made.lost:g} s missing among them; {made.reason}')
    if as_json:
        values = [
            {'bag': str(each.bag), 'steps': each.steps, 'lost_s': each.lost, 'reason': each.reason} for each in found
        ]
        print_json({'recovered': values})


@bag.command()
@click.argument('path', metavar='BAG', type=click.Path(path_type=Path))
@click.option(
    '--format',
    'kind',
    type=click.Choice(['csv', 'parquet', 'netcdf', 'joint-states']),
    required=True,
    help='of the file; joint-states is a bag with the motion as one sample a message, for viewers',
)
@click.option('--output', type=click.Path(path_type=Path), required=True, help='the file, or the folder of the bag')
@overwrite_option
@click.option('--topic', 'topics', multiple=True, help='of the run; all where none is given (several may be given)')
@click.option('--run', 'number', type=int, help='number of the run, where the bag holds several')
@json_option
def export(
    *,
    path: Path,
    kind: str,
    output: Path,
    overwrite: bool,
    topics: tuple[str, ...],
    number: int | None,
    as_json: bool,
) -> None:
    """Write motion, pivot, readings and commands of a run to a file for other tools: units in the column names."""
    from kapitsa_ros.recording.export_files import export as call  # noqa: PLC0415
    from kapitsa_ros.recording.reader import RunBag  # noqa: PLC0415

    run = RunBag(path, number)
    rows = call(run, kind, output, topics, overwrite=overwrite)
    for defect in run.defects:
        warn(f'{path}: {defect}')
    if as_json:
        print_json({'output': str(output), 'rows': rows})
    else:
        # What is no file may be the standard output, where the rows are then.
        click.echo(f'{output}: {rows} rows', err=not output.is_dir() and not output.is_file())


def _values(opened: RunBag) -> dict[str, Any]:
    from dataclasses import asdict  # noqa: PLC0415

    from kapitsa_ros.network.step_clock import SECOND  # noqa: PLC0415

    motion, run = opened.motion, opened.run
    return {
        'messages': opened.messages,
        'duration_s': (opened.last_stamp_ns - opened.first_stamp_ns) / SECOND,
        'complete': opened.complete,
        'gaps': motion.gaps,
        'lost_s': motion.lost,
        'first_stamp_s': opened.first_stamp_ns / SECOND,
        'last_stamp_s': opened.last_stamp_ns / SECOND,
        'run': opened.number,
        'digest': opened.digest,
        'digest_ok': opened.integrity.ok,
        'seed': run.settings['strobe'].get('seed'),
        'plant': asdict(run.plant),
        'versions': run.settings['jigsaw'].get('versions'),
        'processor': opened.processor,
        'defects': list(opened.defects),
    }


def _together(runs: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the values of a bag that holds several runs: of each, and of all."""
    return {
        'messages': sum(run['messages'] for run in runs),
        'duration_s': sum(run['duration_s'] for run in runs),
        'complete': all(run['complete'] for run in runs),
        'gaps': sum(run['gaps'] for run in runs),
        'lost_s': sum(run['lost_s'] for run in runs),
        'first_stamp_s': runs[0]['first_stamp_s'],
        'last_stamp_s': runs[-1]['last_stamp_s'],
        'runs': runs,
    }
