"""What many experiments came to, in a table and sentences."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rich.table import Table

from kapitsa_ros.laboratory.campaign import NOT_TIMED
from kapitsa_ros.reporting.allowances import allowed
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kapitsa_ros.laboratory.campaign import Campaign
    from kapitsa_ros.laboratory.campaign_points import CampaignPoint

_MOST_REASONS, _MOST_SEEDS = 10, 5  # that are listed; a Parquet file holds all
_NOMINAL = 0.95
_SURE = 2.576  # standard deviations: 99 %, two-sided


def campaign_table(found: Campaign, truth: float) -> Table:
    """Return how the critical speeds scatter, and how often their intervals hold; `truth` in rad/s."""
    median, low, high = (speed / RPM for speed in found.omega_crit)
    table = Table(title='Critical speeds of all experiments', title_justify='left', show_header=False)
    table.add_column('')
    table.add_column('', justify='right')
    table.add_row('median ω_crit', f'{median:.1f} RPM')
    table.add_row('16 to 84 %', f'{low:.0f} to {high:.0f} RPM')
    table.add_row('exact threshold of the plant simulated', f'{truth / RPM:.1f} RPM')
    table.add_row('deviation of the median from it', f'{100.0 * (found.omega_crit[0] / truth - 1.0):+.2f} %')
    table.add_row('95 % intervals that hold the truth', f'{100.0 * found.coverage:.1f} %')
    table.add_row('their median width', 'unbounded' if math.isnan(found.width) else f'{found.width / RPM:.0f} RPM')
    table.add_row('intervals with an unbounded end', str(found.unbounded))
    table.add_row('experiments without a critical speed', str(found.failed))
    return table


def points_table(points: Sequence[CampaignPoint], found: Sequence[Campaign]) -> Table:
    """Return a row a point: its values, and what its experiments came to."""
    table = Table(title='Critical speeds at each point', title_justify='left')
    for heading in ('point', *points[0].factors, 'truth (RPM)', 'median', 'deviation', 'hold', 'width (RPM)', 'failed'):
        table.add_column(heading.replace('_', ' '), justify='right')
    for number, (point, each) in enumerate(zip(points, found, strict=True), start=1):
        given = each.experiments > each.failed
        table.add_row(
            str(number),
            *(value if isinstance(value, str) else f'{value:.4g}' for value in point.factors.values()),
            f'{point.truth / RPM:.1f}',
            f'{each.omega_crit[0] / RPM:.1f}' if given else 'none',
            f'{100.0 * (each.omega_crit[0] / point.truth - 1.0):+.2f} %' if given else '',
            f'{100.0 * each.coverage:.0f} %' if given else '',
            f'{each.width / RPM:.0f}' if math.isfinite(each.width) else 'none',
            str(each.failed),
        )
    return table


def failure_sentences(
    points: Sequence[int], seeds: Sequence[int], failures: Sequence[str | None], *, several_points: bool
) -> list[str]:
    """Return what gave no critical speed: how often, why, and with which seeds; the most frequent reasons.

    Parameters
    ----------
    points, seeds, failures
        Of each experiment: index of its point, seed, and why it gave none; None where it gave one.
    several_points
        Whether points are told.

    """
    found: dict[tuple[str, int], list[int]] = {}
    for point, seed, reason in zip(points, seeds, failures, strict=True):
        if reason is not None:
            found.setdefault((reason, point), []).append(seed)
    often = sorted(found.items(), key=lambda item: -len(item[1]))
    lines = []
    for (reason, point), of_seeds in often[:_MOST_REASONS]:
        where = f'point {point + 1}, ' if several_points else ''
        lines.append(f'{len(of_seeds)} without a critical speed: {reason} ({where}{seed_text(of_seeds)})')
    if left := sum(len(of_seeds) for _, of_seeds in often[_MOST_REASONS:]):
        lines.append(f'{left} more without a critical speed: --json and the Parquet file have all')
    return lines


def seed_text(seeds: Sequence[int]) -> str:
    """Return some seeds in words."""
    some = ', '.join(map(str, seeds[:_MOST_SEEDS]))
    more = f' and {len(seeds) - _MOST_SEEDS} more' if len(seeds) > _MOST_SEEDS else ''
    return f'seed{"s" if len(seeds) > 1 else ""} {some}{more}'


def campaign_conclusion(
    found: Campaign, truth: float, assumed: Mapping[str, float], speeds: Sequence[str], failures: Sequence[str | None]
) -> list[str]:
    """Return what the campaign means, and what to do next."""
    given = found.experiments - found.failed
    if not given:
        untimed = set(failures) == {NOT_TIMED}
        what = NOT_TIMED if untimed else 'no experiment gave a critical speed'
        known = f'{what} at {", ".join(speeds)} RPM; the critical speed of this plant is {truth / RPM:.1f} RPM'
        return [known, *(['Next: give a protocol with higher speeds (--protocol).'] if untimed else [])]
    spread = _SURE * math.sqrt(_NOMINAL * (1.0 - _NOMINAL) / given)
    share = f'{100.0 * found.coverage:.0f} % of {given}'
    if found.coverage < _NOMINAL - spread:
        verdict = f'The intervals are too narrow here: {share} hold the truth, where 95 % should.'
    elif found.coverage > _NOMINAL + spread:
        verdict = f'The intervals are wider than they need be here: {share} hold the truth.'
    else:
        verdict = f'The intervals keep what they promise, as far as so many experiments can tell: {share} hold.'
    return [
        f'each interval allows for {allowed(assumed)}',
        verdict,
        'Next: `kapitsa plan --target 1`, with the same rod, names the cheapest protocol for an interval of ±1 %.',
    ]
