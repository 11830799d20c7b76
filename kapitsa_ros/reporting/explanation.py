"""What an explanation rests on, and what it comes to, in a table and sentences."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

from rich.table import Table

from kapitsa_ros.analysis.explain import CAUSES
from kapitsa_ros.units import interval_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.analysis.explain import Explanation, OtherErrors
    from kapitsa_ros.physics.plant import Plant

_CAUSES = {cause.name: cause for cause in CAUSES}
_SHOWN = {'m': (1e-3, 'mm')}
"""Unit that people read, and how much of the SI unit it is."""


def unit_of(explanation: Explanation) -> str:
    """Return the SI unit of the value of an explanation; empty of a ratio."""
    return _CAUSES[explanation.name].unit


HEADINGS = ('cause', 'what is tuned', 'value that fits', '95 %', 'nominal', 'misfit (s)', 'weight')


def explanation_table(explanations: Sequence[Explanation], plant: Plant) -> Table:
    """Return all causes, best first, with the values that fit and those of the plant as it should have been."""
    table = Table(title='Single causes of the periods, best first', title_justify='left')
    for heading in HEADINGS:
        table.add_column(heading, justify='left' if heading in ('cause', 'what is tuned') else 'right')
    for row in explanation_rows(explanations, plant):
        table.add_row(*row)
    return table


def explanation_rows(explanations: Sequence[Explanation], plant: Plant) -> list[tuple[str, ...]]:
    """Return the cells of each cause, under `HEADINGS`."""
    rows: list[tuple[str, ...]] = []
    for each in explanations:
        cause = _CAUSES[each.name]
        factor, unit = _SHOWN.get(cause.unit, (1.0, cause.unit))
        value = 'fits' if each.fits else 'none fits'
        if each.value is not None:
            value = f'{each.value / factor:.3g} {unit}'.strip()
        nominal = cause.nominal_of(plant)
        row = (
            each.name,
            cause.parameter.removesuffix(f', {cause.unit}'),
            value,
            '' if each.interval is None else interval_text(each.interval, partial(_scaled, factor)),
            '' if nominal is None else f'{nominal / factor:.3g} {unit}'.strip(),
            f'{each.rms_misfit:.3f}' if math.isfinite(each.rms_misfit) else 'none',
            f'{each.weight:.2f}' if math.isfinite(each.weight) else 'none',
        )
        rows.append(row)
    return rows


def _scaled(factor: float, value: float) -> str:
    return f'{value / factor:.3g}'


def error_sentences(period_sigma: tuple[float, float], others: Sequence[OtherErrors]) -> list[str]:
    """Return how the ranking depends on the errors that are stated of the periods, a sentence each."""
    low, high = period_sigma
    ends = f'{low:.3g} s' if low == high else f'{low:.3g} to {high:.3g} s'
    said = [f'the ranking rests on a standard uncertainty of each period of {ends}']
    for each in others:
        sigma = f'{low * each.factor:.2g} s' if low == high else f'{each.factor:.2g} of what is stated'
        best = ', '.join(name.replace('_', ' ') for name in each.best) or 'no single cause'
        said.append(f'{each.name} ({sigma}): {best}')
    return said


def explanation_conclusion(explanations: Sequence[Explanation], indistinguishable: Sequence[str]) -> list[str]:
    """Return what the ranking comes to, and what to do next."""
    fitting = [each.name for each in explanations if each.fits]
    if not fitting:
        return [
            'No single cause makes the periods what they are: there are several, or one that is not in the list.',
            'Next: look at single runs; `kapitsa analyse RUNS --motion` takes the period from the motion.',
        ]
    if not indistinguishable:
        return [
            f'One cause stands alone by its weight: {fitting[0]}. A good fit is no proof of it.',
            'Next: measure its value by itself, or time a swing where it would tell most.',
        ]
    first, second = indistinguishable[:2]
    return [
        f'These readings cannot tell apart: {", ".join(indistinguishable)}.',
        f'Next: `kapitsa plan --target 1 --between {first} {second}` names the timing that decides between two.',
    ]
