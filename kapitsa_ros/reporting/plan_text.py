"""A planned protocol in a table and sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.table import Table

from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.analysis.plan import Separation

_APART = 2.0  # standard uncertainties; closer values are not distinguished


def plan_table(speeds: Sequence[float], swings: int, repeats: int) -> Table:
    """Return the runs of a protocol; speeds in rad/s."""
    table = Table(title='The cheapest protocol', title_justify='left')
    for heading in ('run', 'ω (RPM)', 'timings', 'swings in each'):
        table.add_column(heading, justify='right')
    for number, speed in enumerate(speeds, start=1):
        table.add_row(str(number), f'{speed / RPM:.0f}', str(repeats), str(swings))
    return table


def plan_sentences(
    speeds: Sequence[float], swings: int, repeats: int, *, expected_percent: float, seconds: float, release: str
) -> list[str]:
    """Return what is expected of a protocol, and how to carry it out."""
    spent = f'{seconds:.0f} s' if seconds < 120.0 else f'{seconds / 60.0:.0f} min'
    listed = ', '.join(f'{speed / RPM:.0f} rpm' for speed in speeds)
    protocol = f'`speeds: [{listed}]`, `release: {release}`, `swings: {swings}` and `repeats: {repeats}`'
    return [
        f'Expected: a 95 % interval of ±{expected_percent:.2f} % about the critical speed, after {spent} at the bench.',
        f'Next: in a file mine.yaml, {protocol}, a line each; then `kapitsa experiment --protocol mine.yaml`.',
    ]


def separation_sentence(found: Separation) -> str:
    """Return the timing that tells two explanations apart."""
    first, second = found.between
    swing = 'the swing as before' if found.release is None else f'a swing of {found.release:g} rad'
    what = f'time {swing} at {found.speed / RPM:.0f} RPM'
    apart = f'{found.sigmas:.1f} standard uncertainties apart'
    predictions = f'they say {found.periods[0]:.2f} s and {found.periods[1]:.2f} s, {apart}'
    if found.sigmas < _APART:
        return f'No single timing tells {first} from {second}; the best of them: {what}; {predictions}.'
    return f'To tell {first} from {second}: {what}; {predictions}.'
