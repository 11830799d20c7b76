"""What an explanation rests on, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.analysis.explain import OtherErrors


def error_sentences(period_sigma: tuple[float, float], others: Sequence[OtherErrors]) -> list[str]:
    """Return how the ranking depends on the errors that are stated of the periods, a sentence each."""
    low, high = period_sigma
    ends = f'{low:.3g} s' if low == high else f'{low:.3g} to {high:.3g} s'
    said = [f'the ranking rests on an error of each period of {ends}']
    for each in others:
        sigma = f'{low * each.factor:.2g} s' if low == high else f'{each.factor:.2g} of what is stated'
        best = ', '.join(name.replace('_', ' ') for name in each.best) or 'no single cause'
        said.append(f'{each.name} ({sigma}): {best}')
    return said
