"""`kapitsa campaign`: many virtual experiments."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from kapitsa_ros._api.campaign import campaign as call
from kapitsa_ros.cli.options import assumption_option, instrument_options, json_option, plant_options, print_json
from kapitsa_ros.cli.progress import counted_off
from kapitsa_ros.cli.terminal import say, show_table
from kapitsa_ros.configuration.campaign_ranges import load_ranges
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.reporting.campaign_text import campaign_conclusion, campaign_table, failure_sentences, points_table
from kapitsa_ros.reporting.plant_sentence import plant_sentence
from kapitsa_ros.schema import describe
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kapitsa_ros._api.campaign import CampaignResult
    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.laboratory.campaign import Campaign, Outcome


@click.command()
@click.option(
    '--experiments',
    type=click.IntRange(1),
    help='how many at each point, with the seeds 1, 2, 3..., which go on from point to point  [default: as the file of '
    'ranges says]',
)
@click.option(
    '--ranges',
    type=click.Path(path_type=Path, dir_okay=False),
    help='YAML file of what is varied: names of parameters, presets, instruments, protocols, and their values',
)
@click.option('--protocol', default='1997', show_default=True, help='name of a shipped protocol, or a YAML file')
@click.option(
    '--output',
    type=click.Path(path_type=Path, dir_okay=False),
    help='Parquet file for the outcomes; what is finished is kept beside it, should the campaign end early',
)
@click.option('--resume', is_flag=True, help='go on with the campaign of which a part is there')
@click.option('--scheduler', metavar='ADDR', help='of a Dask cluster; without it all cores of this machine compute')
@plant_options
@instrument_options
@assumption_option
@json_option
def campaign(
    *,
    experiments: int | None,
    ranges: Path | None,
    protocol: str,
    output: Path | None,
    resume: bool,
    scheduler: str | None,
    plant: Plant,
    instruments: Instruments,
    assumptions: Assumptions,
    as_json: bool,
) -> None:
    """Carry out many whole experiments in process, and count how often their intervals tell the truth.

    With --ranges they are carried out at each of many points; `kapitsa report --campaign` makes a report of the
    outcomes that --output has written.
    """
    if experiments is None and ranges is None:
        raise click.UsageError('say how many: --experiments N')
    if resume and output is None:
        raise click.UsageError('--resume goes on with the file of --output: give that too')
    if ranges is not None:
        _refuse_what_is_varied(ranges)
    result = call(
        plant,
        experiments=experiments,
        instruments=instruments,
        protocol=protocol,
        ranges=ranges,
        output=output,
        resume=resume,
        scheduler=scheduler,
        assumptions=assumptions,
        progress=_progress,
    )
    found = result.summary
    if as_json:
        points = {'points': _points(result), 'failures': _failures(result)} if ranges is not None else {}
        print_json(_values(found) | {'wall_s': result.wall, 'efficiency': result.efficiency} | points)
        return
    if ranges is None:
        _show_one_point(result, plant, [f'{speed / RPM:.0f}' for speed in load_protocol(protocol).speeds])
    else:
        _show_points(result, ranges)
    if output is not None:
        click.echo(f'{output}')
        click.echo(f'Next: kapitsa report --campaign {output} --output campaign.html')


def _refuse_what_is_varied(ranges: Path) -> None:
    """Refuse options that a factor of the ranges replaces: nobody would see that they have no effect."""
    varied = load_ranges(ranges).factors
    context = click.get_current_context()
    typed = {name for name in context.params if context.get_parameter_source(name) is ParameterSource.COMMANDLINE}
    typed |= {name for name, _ in context.params['overrides']}
    plant = {item.name for item in describe(Plant)}
    replaced = {'preset': plant, 'instruments': {'overrides'}}
    for factor in varied:
        for name in sorted(typed & ({factor} | replaced.get(factor, set()))):
            option = 'instrument' if name == 'overrides' else name.replace('_', '-')
            raise click.UsageError(f'--{option} has no effect beside the factor {factor}: vary it in {ranges}')


def _progress(stream: Iterator[Outcome], total: int) -> Iterable[Outcome]:
    return counted_off(stream, 'experiments', total)


def _show_one_point(result: CampaignResult, plant: Plant, speeds: list[str]) -> None:
    found = result.summary
    say([f'{plant_sentence(plant)}. {found.experiments} experiments at {", ".join(speeds)} RPM, {result.wall:.1f} s.'])
    if found.failed < found.experiments:
        show_table(campaign_table(found, result.truth))
    say(failure_sentences(result.point.tolist(), result.seed.tolist(), result.failure, several_points=False))
    say(campaign_conclusion(found, result.truth, asdict(result.assumptions), speeds, result.failure))


def _show_points(result: CampaignResult, ranges: Path) -> None:
    found = result.summary
    say([f'{found.experiments} experiments at {len(result.points)} points of {ranges}, {result.wall:.1f} s.'])
    show_table(points_table(result.points, result.at_points))
    say(failure_sentences(result.point.tolist(), result.seed.tolist(), result.failure, several_points=True))


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


def _failures(result: CampaignResult) -> list[dict[str, Any]]:
    return [
        {'point': point + 1, 'seed': seed, 'reason': reason}
        for point, seed, reason in zip(result.point.tolist(), result.seed.tolist(), result.failure, strict=True)
        if reason is not None
    ]


def _points(result: CampaignResult) -> list[dict[str, Any]]:
    return [
        {'values': dict(point.factors), 'truth_rpm': point.truth / RPM} | _values(found)
        for point, found in zip(result.points, result.at_points, strict=True)
    ]
