"""The person's own readings, on the screen and on disk."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.analysis.table import Readings, refuse_mixed_units
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from pathlib import Path


_COLUMNS = ('forcing_rpm', 'period_s', 'release_rad', 'swings', 'display_s', 'run')


@dataclass(frozen=True, kw_only=True)
class Row:
    """One line of the table: what was read, and what it was read of."""

    run: int
    forcing_rpm: float
    period_s: float
    display_s: float
    """On the stopwatch."""
    swings: int
    """That the display stands for."""
    release_rad: float
    """From which the pendulum was last let go; nan where it never was."""


class Notebook:
    """A table that is on disk as soon as a line is written, in the form that `kapitsa reduce` takes.

    Parameters
    ----------
    path
        Of the CSV file; it is made with the first line.

    Raises
    ------
    UsageError
        The file is there already, or its folder is not.

    """

    def __init__(self, path: Path) -> None:
        if path.exists():
            raise UsageError(f'--table {path} exists: readings are never overwritten, give another name')
        if not path.parent.is_dir() or not os.access(path.parent, os.W_OK | os.X_OK):
            raise UsageError(f'--table {path}: its folder cannot be written; give another name')
        self.path = path
        self.rows: list[Row] = []

    def write_down(self, row: Row) -> None:
        """Add a line.

        Raises
        ------
        TableError
            No run can have such readings; the message says what is wrong.
        OSError
            The disk does not take it.

        """
        if row.forcing_rpm <= 0 or row.period_s <= 0:
            raise TableError('set the dial of the lamp and time a swing, then write it down')
        typed = Readings(
            forcing=np.array([row.forcing_rpm * RPM]),
            period=np.array([row.period_s]),
            forcing_sigma=np.zeros(1),
            period_sigma=np.zeros(1),
        )
        refuse_mixed_units(typed)
        self._save([*self.rows, row])

    def strike_out(self) -> Row | None:
        """Remove the last line and return it; None where there is none."""
        if not self.rows:
            return None
        last = self.rows[-1]
        self._save(self.rows[:-1])
        return last

    def _save(self, rows: list[Row]) -> None:
        """Put the whole table in place of the old one, so that it is never half-written."""
        if rows:
            lines = [','.join(_COLUMNS), *(_line(row) for row in rows)]
            draft = self.path.with_name(f'.{self.path.name}.new')
            draft.write_text('\n'.join(lines) + '\n', encoding='utf-8')
            draft.replace(self.path)
        else:
            self.path.unlink(missing_ok=True)
        self.rows = rows


def _line(row: Row) -> str:
    values = (getattr(row, name) for name in _COLUMNS)
    return ','.join('' if math.isnan(value) else f'{value:.10g}' for value in values)
