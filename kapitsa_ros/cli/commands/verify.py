"""`kapitsa verify`."""

from __future__ import annotations

import sys
from contextlib import nullcontext
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from kapitsa_ros.cli.options import bags_argument, json_option, print_json
from kapitsa_ros.cli.warnings_of_bags import warn
from kapitsa_ros.errors import FAILED

if TYPE_CHECKING:
    from pathlib import Path

    from kapitsa_ros._api.verify import VerifiedRun


@click.command()
@bags_argument
@click.option('--digest', metavar='HEX', help='what the digest of the run has to be')
@click.option('--graph', is_flag=True, help='let the nodes do the runs again; in this process otherwise')
@json_option
def verify(*, bags: tuple[Path, ...], digest: str | None, graph: bool, as_json: bool) -> None:
    """Compute recorded runs again from commands, settings and seed, and compare every message to the last bit."""
    from kapitsa_ros._api.verify import verify as call  # noqa: PLC0415
    from kapitsa_ros.cli.node_server import node_server  # noqa: PLC0415
    from kapitsa_ros.cli.progress import shown_progress  # noqa: PLC0415
    from kapitsa_ros.recording.processor import processor  # noqa: PLC0415
    from kapitsa_ros.versions import versions  # noqa: PLC0415

    with (
        node_server() if graph else nullcontext(),
        shown_progress(len(bags)) if graph else nullcontext() as on_progress,
    ):
        runs = call(bags, digest, graph=graph, on_progress=on_progress)
    values = [_values(run, versions(), processor()) for run in runs]
    for run in runs:
        for defect in run.bag.defects:
            warn(f'{run.bag.path}: {defect}')
    if as_json:
        print_json({'bags': values})
    else:
        for value in values:
            click.echo(_sentence(value))
    if not all(run.identical for run in runs):
        sys.exit(FAILED)


def _values(run: VerifiedRun, here: dict[str, str], processor_here: tuple[str, ...]) -> dict[str, Any]:
    found = run.verification
    recorded = run.bag.run.settings['jigsaw'].get('versions', {})
    return {
        'bag': str(run.bag.path),
        'run': run.bag.number,
        'identical': run.identical,
        'digest': found.digest,
        'first_difference': None if found.first_difference is None else asdict(found.first_difference),
        'largest_ulp': found.largest_ulp,
        'other_versions': {
            name: {'recorded': recorded.get(name), 'here': version}
            for name, version in here.items()
            if recorded.get(name) != version
        },
        'other_processor': None
        if run.bag.processor == processor_here
        else {'recorded': run.bag.processor, 'here': processor_here},
    }


def _sentence(value: dict[str, Any]) -> str:
    which = f'{value["bag"]}, run {value["run"]}'
    if value['identical']:
        return f'{which}: identical, digest {value["digest"]}'
    first = value['first_difference']
    if first is None:
        return f'{which}: identical to its bag, but the digest is {value["digest"]}'
    text = (
        f'{which}: {first["topic"]} differs first at step {first["step"]}, {first["field"]}: '
        f'recorded {first["recorded"]}, computed {first["recomputed"]}; largest difference {value["largest_ulp"]} ULP'
    )
    others = [f'{name} {each["recorded"]}, here {each["here"]}' for name, each in value['other_versions'].items()]
    if (other := value['other_processor']) is not None:
        features, settings = zip(*(_apart(other[which]) for which in ('recorded', 'here')), strict=True)
        if other['recorded'] is None:
            others.append(f'a processor that the bag does not tell, here {_only(features[1], ())}')
        elif features[0] != features[1]:
            others.append(f'{_only(*features)}, here {_only(*reversed(features))}')
        for name in sorted({*settings[0], *settings[1]}):
            recorded, here = (repr(each[name]) if name in each else 'unset' for each in settings)
            others.append(f'{name} {recorded}, here {here}')
    if not others:
        return f'{text}, under the same versions and on the same processor: something was changed'
    return f'{text}; recorded with {"; ".join(others)}: a change is only what differs under the same'


def _apart(processor: tuple[str, ...] | None) -> tuple[tuple[str, ...], dict[str, str]]:
    """Return what a processor has, and how numba was set to use it."""
    settings = dict(each.split('=', 1) for each in processor or () if '=' in each)
    return tuple(each for each in processor or () if '=' not in each), settings


def _only(processor: tuple[str, ...], other: tuple[str, ...]) -> str:
    """Return what one processor has and the other lacks, as a person names it."""
    own = [each for each in processor if each not in other]
    return f'a processor with {" ".join(own)}' if own else 'a processor without'
