"""What is in a recorded run, in a table and sentences."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from rich.table import Table

from kapitsa_ros.units import RPM, counted

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kapitsa_ros.network.run import Run

_TITLES = {'first_stamp_s': 'first stamp (s)', 'last_stamp_s': 'last stamp (s)', 'lost_s': 'motion missing (s)'}
_TITLES |= {'duration_s': 'simulated time (s)', 'complete': 'came to its end', 'gaps': 'gaps in the motion'}
_TITLES |= {'digest_ok': 'bytes are those recorded'}


def bag_table(values: Mapping[str, Any]) -> Table:
    """Return the values of a bag that are a number or a word."""
    table = Table(title='What is in the bag', title_justify='left', show_header=False)
    table.add_column('')
    table.add_column('', justify='right')
    for name, value in values.items():
        if name == 'digest':  # longer than a table is wide
            continue
        if name == 'digest_ok' and value is None:
            table.add_row(_TITLES[name], 'unverified: no digest')
        elif isinstance(value, bool):
            table.add_row(_TITLES.get(name, name), 'yes' if value else 'no')
        elif isinstance(value, int | float | str):
            shown = f'{value:.10g}' if isinstance(value, float) else str(value)
            table.add_row(_TITLES.get(name, name), shown)
    return table


def bag_conclusion(values: Mapping[str, Any], run: Run, path: str, absent: Sequence[str] = ()) -> list[str]:
    """Return what the run is, whether it is whole but for the topics that are absent, and what to do next."""
    kinds = Counter(timing.kind for timing in run.timings)
    swings = ', '.join(f'{number} {kind}' for kind, number in kinds.items()) or 'none timed'
    said = [f'Swings: {swings}; {run.speed_asked / RPM:.0f} RPM asked for.']
    if not values['complete']:
        said.append('The run was interrupted: what was recorded until then is there.')
    if values['gaps']:
        said.append(f'{values["lost_s"]:.3g} s of motion are missing, in {counted(values["gaps"], "place")}.')
    elif values['complete'] and absent:
        said.append(f'The run came to its end, but nothing of {", ".join(absent)} was recorded.')
    elif values['complete']:
        said.append('The run is whole: it came to its end, and no sample of the motion is missing.')
    said.append(f'Digest: {values["digest"]}')
    return [*said, f'Next: `kapitsa analyse {path}` takes the critical speed from it.']
