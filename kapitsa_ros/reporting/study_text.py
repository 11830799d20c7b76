"""How solvers compare, in a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.table import Table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.physics.solver_comparison import SolverResult


def solvers_table(results: Sequence[SolverResult]) -> Table:
    """Return what each solver makes of the frictionless rod."""
    table = Table(title='A frictionless rod, as solvers see it', title_justify='left')
    for heading in ('solver', 'followed (s)', 'growth (1/s)', 'amplitude', 'fell at', 'CPU (s)'):
        table.add_column(heading, justify='left' if heading == 'solver' else 'right')
    for result in results:
        table.add_row(
            result.solver,
            f'{result.duration:.0f}',
            f'{result.growth:.2e}',
            f'× {result.amplitude_ratio:.5f}',
            'stands' if result.fell_at is None else f'{result.fell_at:.0f} s',
            f'{result.cpu:.2f}',
        )
    return table
