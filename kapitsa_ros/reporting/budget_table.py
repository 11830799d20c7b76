"""The uncertainty budget as a table and sentences, for terminals and pages."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from kapitsa_ros.units import RPM, digits_of

if TYPE_CHECKING:
    from collections.abc import Mapping

HEADINGS = ('input', 'value', 'u', 'type', 'distribution', 'sensitivity', 'contribution (RPM)')
_SHOWN = {'m': (1e-3, 'mm'), 'rad/s': (RPM, 'RPM'), '': (0.01, '%')}
"""Unit that people read, and how much of the SI unit it is."""
_SLIGHT = 0.05  # correlation that is not worth a word


def budget_rows(values: Mapping[str, Any]) -> list[tuple[str, ...]]:
    """Return the cells of each input, under `HEADINGS`; digits follow from the uncertainty."""
    rows: list[tuple[str, ...]] = []
    for item in values['inputs']:
        factor, unit = _SHOWN.get(item['unit'], (1.0, item['unit']))
        u = item['u'] / factor
        digits = digits_of(u)
        sensitivity = item['sensitivity_rpm'] * factor
        rows.append(
            (
                item['name'],
                f'{item["value"] / factor:.{digits}f} {unit}',
                f'{u:.{digits}f} {unit}',
                item['type'],
                item['distribution'],
                f'{sensitivity:.3g} RPM/({unit})' if '/' in unit else f'{sensitivity:.3g} RPM/{unit}',
                f'{item["contribution_rpm"]:.1f}',
            )
        )
    return rows


def budget_sentences(values: Mapping[str, Any]) -> list[str]:
    """Return what the inputs come to together."""
    carlo = values['monte_carlo']
    digits = digits_of(values['u_rpm'])
    freedom = values['degrees_of_freedom']
    freely = 'unlimited' if not math.isfinite(freedom) else f'{freedom:.1f}'
    u, expanded, value = (f'{values[name]:.{digits}f} RPM' for name in ('u_rpm', 'expanded_rpm', 'value_rpm'))
    low, high = (f'{end:.{digits}f}' for end in carlo['interval_rpm'])
    mean, spread = (f'{carlo[name]:.{digits}f} RPM' for name in ('value_rpm', 'u_rpm'))
    factor = f'k = {values["coverage_factor"]:.2f}'
    said = [
        f'combined standard uncertainty u_c = {u}; effective degrees of freedom {freely}; {factor}',
        f'expanded uncertainty (95 %) U = {expanded} about {value}, where play, damping and friction are as expected',
        'counts of swings are taken as right, or as repaired: a miscount has no share in it',
        f'Monte Carlo, {carlo["draws"]} draws: u = {spread} about {mean}, 95 % from {low} to {high} RPM',
    ]
    if not values['linear']:
        percent = 100.0 * (values['u_rpm'] / carlo['u_rpm'] - 1.0)
        said.append(f"the model is not linear enough: u_c is {percent:+.0f} % off, and Monte Carlo's values hold")
    pairs = [f'{one} with {other} {r:+.2f}' for one, other, r in values['correlations'] if abs(r) >= _SLIGHT]
    if pairs:
        said.append(f'correlated inputs: {", ".join(pairs)}')
    return said
