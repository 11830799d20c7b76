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
        recorded = 'a processor that the bag does not tell' if other['recorded'] is None else _only(other, 'recorded')
        others.append(f'{recorded}, here {_only(other, "here")}')
    if not others:
        return f'{text}, under the same versions and on the same processor: something was changed'
    return f'{text}; recorded with {"; ".join(others)}: a change is only what differs under the same'


def _only(processors: dict[str, tuple[str, ...]], which: str) -> str:
    """Return what one processor has and the other lacks, as a person names it."""
    [other] = (processors[name] or () for name in processors if name != which)
    own = [each for each in processors[which] if each not in other]
    return f'a processor with {" ".join(own)}' if own else 'a processor without'
