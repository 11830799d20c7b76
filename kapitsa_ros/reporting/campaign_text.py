"""What many experiments came to, in a table and sentences."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rich.table import Table

from kapitsa_ros.reporting.allowances import allowed
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kapitsa_ros.laboratory.campaign import Campaign

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


def campaign_conclusion(
    found: Campaign, truth: float, assumed: Mapping[str, float], speeds: Sequence[str]
) -> list[str]:
    """Return what the campaign means, and what to do next."""
    given = found.experiments - found.failed
    if not given:
        untimed = f'no swing could be timed at {", ".join(speeds)} RPM'
        return [
            f'{untimed}; the critical speed of this plant is {truth / RPM:.1f} RPM',
            'Next: give a protocol with higher speeds (--protocol).',
        ]
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
