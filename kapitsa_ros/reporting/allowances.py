"""What an interval allows for besides the errors of the readings, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

_FEW = 20.0  # rods, of which the quantiles of an interval are taken


def allowances(
    assumed: Mapping[str, float],
    play_probability: float | None,
    heavy_damping_probability: float | None,
    effective_rods: float | None,
) -> list[str]:
    """Return what the interval allows for besides the errors of the readings, a sentence each; None without any."""
    if play_probability is None or heavy_damping_probability is None or effective_rods is None:
        return []
    play, heavy = _in_percent(play_probability), _in_percent(heavy_damping_probability)
    seen = f'play is {play} probable, and more than light damping {heavy}'
    said = [f'the interval allows for {allowed(assumed)}; by these readings, {seen}']
    if effective_rods < _FEW:
        said.append(f'few rods of the sample explain readings so exact ({effective_rods:.0f}): its ends are rough')
    return said


def allowed(assumed: Mapping[str, float]) -> str:
    """Return what intervals allow for by what is taken for granted."""
    named = [
        f'{name} up to {factor * assumed[limit]:.3g}{unit}'
        for name, probability, limit, factor, unit in (
            ('play', 'play_probability', 'play_limit', 1e3, ' mm'),
            ('damping', 'heavy_damping_probability', 'heavy_damping_limit', 1.0, ' 1/s'),
        )
        if assumed[probability]
    ]
    if assumed['coulomb_probability']:
        named.append('Coulomb friction')
    if assumed['miscount_probability']:
        named.append(f'a miscount in {100.0 * assumed["miscount_probability"]:.3g} % of timings with a count')
    named += [
        f'{what} (u = {100.0 * assumed[name]:.3g} %)'
        for name, what in (('stopwatch_rate_u', 'the rate of the stopwatch'), ('dial_u', 'the calibration of the dial'))
        if assumed[name]
    ]
    return ', '.join(named) or 'light damping alone'


def _in_percent(probability: float) -> str:
    return f'{100.0 * probability:.0f} %'
