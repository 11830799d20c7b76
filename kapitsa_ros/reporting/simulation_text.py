"""What became of one release, in a table and sentences."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from rich.table import Table

from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_SLOWEST = 1e-6  # 1/s; a growth below is none


def simulation_table(
    values: Mapping[str, Any], speed_text: Callable[[float], str], angle_text: Callable[[float], str]
) -> Table:
    """Return the numbers of a run; speeds (rad/s) and angles (rad) are written in the unit that was typed."""
    table = Table(title='What became of it', title_justify='left', show_header=False)
    table.add_column('')
    table.add_column('', justify='right')
    slow, growth, periods = values['slow_rpm'], values['growth_per_s'], values['periods']
    table.add_row('slow swing Ω', 'none' if slow is None else speed_text(slow * RPM))
    table.add_row('one swing takes', 'none' if not slow else f'{60.0 / slow:.4g} s')
    table.add_row('swings seen', 'none' if periods is None else f'{periods:.1f}')
    grows = 'too short to tell' if growth is None else 'none' if abs(growth) < _SLOWEST else f'{growth:+.3g} 1/s'
    table.add_row('growth of its amplitude', grows)
    table.add_row('largest angle', angle_text(values['max_angle_rad']))
    table.add_row('angle at the end', angle_text(values['final_angle_rad']))
    return table


def simulation_conclusion(values: Mapping[str, Any], *, falls: bool, end: str) -> list[str]:
    """Return what became of the rod, and what to do next; `end` is the angle at the end in words."""
    growth = values['growth_per_s'] or 0.0
    compare = 'Next: `kapitsa theory`, with the same rod, speed and release, compares this with the theories.'
    if values['fell']:
        return ['It fell.', 'Next: `kapitsa theory`, with the same rod, says from which speed on it stands.']
    if falls:
        return [
            'unstable: it would fall, if it were followed for longer',
            'Next: `kapitsa theory`, with the same rod, says from which speed on it stands.',
        ]
    if values['stuck']:
        return [f'Friction has stopped it at {end} from upright, and holds it there.', compare]
    if growth < -_SLOWEST:
        return [f'It stands, and its swing dies: to half in {math.log(0.5) / growth:.2g} s.', compare]
    return ['It stands: it swings about upright, and the swing neither grows nor dies.', compare]
