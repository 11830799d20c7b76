"""What an interval allows for besides the errors of the readings, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping


def allowances(values: Mapping[str, Any]) -> list[str]:
    """Return what the interval allows for besides the errors of the readings, a sentence each."""
    if values['play_probability'] is None:
        return []
    play, heavy = _in_percent(values['play_probability']), _in_percent(values['heavy_damping_probability'])
    assumed = values['assumptions']
    allowed = [
        f'{name} up to {factor * assumed[limit]:.3g}{unit}'
        for name, probability, limit, factor, unit in (
            ('play', 'play_probability', 'play_limit', 1e3, ' mm'),
            ('damping', 'heavy_damping_probability', 'heavy_damping_limit', 1.0, ' 1/s'),
        )
        if assumed[probability]
    ]
    allowed += [
        f'{what} of u = {100.0 * assumed[name]:.3g} %'
        for name, what in (('stopwatch_rate_u', "an error of the stopwatch's rate"), ('dial_u', 'an error of the dial'))
        if assumed[name]
    ]
    seen = f'play is {play} probable, and more than light damping {heavy}'
    return [f'the interval allows for {", ".join(allowed) or "light damping alone"}; by these readings, {seen}']


def _in_percent(probability: float) -> str:
    return f'{100.0 * probability:.0f} %'
