"""What theory says of a rod, in tables and sentences."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from rich.table import Table

from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    AsTyped = Callable[[float], str]
    """Writes a speed, rad/s, in the unit that was typed."""

_SLOWEST = 1e-9  # 1/s; a growth below is none


def critical_speeds_table(values: Mapping[str, Any], as_typed: AsTyped) -> Table:
    """Return the critical speeds of a rod."""
    table = _table('Critical speed of the upright rod', '', 'ω')
    for label, key in (
        ('averaged theory (report, eq. 8)', 'omega_crit_averaged_rpm'),
        ('exact (Floquet)', 'omega_crit_exact_rpm'),
        ('upper limit: unstable again from', 'omega_crit_upper_rpm'),
    ):
        rpm = values[key]
        typed = '' if rpm is None else as_typed(rpm * RPM)
        others = '' if typed.lower().endswith('rpm') else f' ({typed})'
        table.add_row(label, 'none' if rpm is None else f'{rpm:.2f} RPM{others}')
    return table


def speeds_table(rows: Sequence[tuple[Mapping[str, Any], AsTyped]]) -> Table:
    """Return what the rod does at each speed."""
    table = _table('At these speeds', 'ω', 'upright', 'Ω averaged (eq. 15)', 'Ω exact', 'a swing takes', 'growth')
    for row, as_typed in rows:
        averaged, exact = (
            'none' if row[key] is None else as_typed(row[key] * RPM) for key in ('slow_averaged_rpm', 'slow_exact_rpm')
        )
        takes = 'none' if not row['slow_exact_rpm'] else f'{60.0 / row["slow_exact_rpm"]:.4g} s'
        growth = row['growth_per_s']
        grows = 'none' if abs(growth) < _SLOWEST else f'{growth:+.4g} 1/s'
        stands = 'stands' if row['stable'] else 'falls'
        table.add_row(as_typed(row['speed_rpm'] * RPM), stands, averaged, exact, takes, grows)
    return table


def comparison_table(row: Mapping[str, Any], as_typed: AsTyped, release: str) -> Table:
    """Return the theories compared at one speed."""
    title = f'Theories of a swing let go at {release}, at {as_typed(row["speed_rpm"] * RPM)}'
    table = _table(title, 'theory', 'source', 'Ω', 'deviation')
    for each in row['ladder']:
        slow, error = each['slow_rpm'], each['error_rpm']
        found = ('none', '') if slow is None else (as_typed(slow * RPM), f'{error:+.4f} RPM')
        table.add_row(each['name'], each['source'], *found)
    return table


def theory_conclusion(values: Mapping[str, Any], speeds: Sequence[tuple[Mapping[str, Any], AsTyped]]) -> list[str]:
    """Return what it means, and what to do next."""
    critical, upper = values['omega_crit_exact_rpm'], values['omega_crit_upper_rpm']
    limit = '' if upper is None else f' and below {upper:.0f} RPM'
    said = [f'The rod stands upright above {critical:.1f} RPM{limit}, and falls elsewhere.']
    for row, as_typed in speeds:
        speed, growth = as_typed(row['speed_rpm'] * RPM), row['growth_per_s']
        if not row['stable']:
            said.append(f'At {speed} it falls: its angle grows tenfold in {math.log(10.0) / growth:.2g} s.')
        elif row['slow_exact_rpm'] and growth < -_SLOWEST:
            said.append(f'At {speed} it swings, and a swing has died to half after {math.log(0.5) / growth:.2g} s.')
    if speeds:
        return [*said, 'Next: `kapitsa simulate`, with the same rod and speed, follows one release of it.']
    return [*said, 'Next: `kapitsa theory --speed 2500` says how it swings there.']


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify='left')
    for index, column in enumerate(columns):
        table.add_column(column, justify='right' if index else 'left')
    return table
