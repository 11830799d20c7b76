"""The person's own readings, on the screen and on disk."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.analysis.table import Readings, refuse_mixed_units
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from pathlib import Path


_COLUMNS = ('forcing_rpm', 'period_s', 'release_rad', 'swings', 'display_s', 'run')

_NOTE, _STRUCK = '# ', '# struck out: '


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


@dataclass(frozen=True)
class WrittenRow:
    """A reading in the table."""

    row: Row
    struck: bool = False


BookLine: TypeAlias = WrittenRow | str
"""A reading or a remark."""


class Notebook:
    """A table that is on disk as soon as a line is written, in the form that `kapitsa reduce` takes.

    Parameters
    ----------
    path
        Of the CSV file; it is made with the first line.
    continued
        Whether a file that is there is gone on with.

    Raises
    ------
    UsageError
        The file is there already, or its folder is not.
    TableError
        A file that is to be gone on with is no such table.

    """

    def __init__(self, path: Path, *, continued: bool = False) -> None:
        there = path.exists()
        if there and not continued:
            raise UsageError(f'--table {path} exists: readings are never overwritten, give another name')
        if not path.parent.is_dir() or not os.access(path.parent, os.W_OK | os.X_OK):
            raise UsageError(f'--table {path}: its folder cannot be written; give another name')
        self.path = path
        self.lines: list[BookLine] = _read(path) if there else []
        """All that was ever written, in its order."""

    @property
    def rows(self) -> list[Row]:
        """The lines that are not struck out."""
        return [line.row for line in self.lines if isinstance(line, WrittenRow) and not line.struck]

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
        self._save([*self.lines, WrittenRow(row)])

    def note(self, text: str) -> None:
        """Add a remark, of one line.

        Raises
        ------
        OSError
            The disk does not take it.

        """
        line = ' '.join(text.split())
        self._save([*self.lines, text if text == line else line])  # a `Message` stays one

    def strike_out(self, number: int | None = None) -> Row | None:
        """Strike a line out: it stays legible, and is no reading any more.

        Parameters
        ----------
        number
            Of the line among all readings, from 1; None: the last that is not struck out.

        Returns
        -------
        Row or None
            What was struck out; None where nothing is written down.

        Raises
        ------
        TableError
            There is no such line, or it is struck out already.
        OSError
            The disk does not take it.

        """
        places = [place for place, line in enumerate(self.lines) if isinstance(line, WrittenRow)]
        open_places = [place for place in places if not self._written(place).struck]
        if number is None:
            if not open_places:
                return None
            place = open_places[-1]
        else:
            if not 1 <= number <= len(places) or places[number - 1] not in open_places:
                raise TableError('line {number} is not there, or is struck out already', number=number)
            place = places[number - 1]
        row = self._written(place).row
        lines = list(self.lines)
        lines[place] = WrittenRow(row, struck=True)
        self._save(lines)
        return row

    def _written(self, place: int) -> WrittenRow:
        line = self.lines[place]
        assert isinstance(line, WrittenRow)  # noqa: S101  # by who asks
        return line

    def text(self) -> str:
        """Return the table as it is on disk: CSV, in which what is no reading is a comment."""
        return '\n'.join([','.join(_COLUMNS), *(_text(line) for line in self.lines)]) + '\n'

    def _save(self, lines: list[BookLine]) -> None:
        """Put the whole table in place of the old one, so that it is never half-written."""
        before, self.lines = self.lines, lines
        try:
            draft = self.path.with_name(f'.{self.path.name}.new')
            draft.write_text(self.text(), encoding='utf-8')
            draft.replace(self.path)
        except OSError:
            self.lines = before
            raise


def _read(path: Path) -> list[BookLine]:
    """Return what `Notebook.text` has written."""
    try:
        header, *texts = path.read_text(encoding='utf-8').splitlines()
        lines = [_parsed(text) for text in texts]
    except (OSError, ValueError) as error:
        raise TableError(f'{path}: cannot be gone on with ({error}): it is no book of a bench') from error
    if header != ','.join(_COLUMNS):
        raise TableError(f'{path}: has other columns than the book of a bench')
    return lines


def _parsed(text: str) -> BookLine:
    if text.startswith(_STRUCK):
        return WrittenRow(_row(text.removeprefix(_STRUCK)), struck=True)
    return text.removeprefix(_NOTE) if text.startswith(_NOTE) else WrittenRow(_row(text))


def _row(text: str) -> Row:
    numbers = [float(cell) if cell else math.nan for cell in text.split(',')]
    values: dict[str, Any] = dict(zip(_COLUMNS, numbers, strict=True))
    return Row(**values | {name: int(values[name]) for name in ('run', 'swings')})


def _text(line: BookLine) -> str:
    if isinstance(line, str):
        return f'{_NOTE}{line}'
    return f'{_STRUCK}{_line(line.row)}' if line.struck else _line(line.row)


def _line(row: Row) -> str:
    values = (getattr(row, name) for name in _COLUMNS)
    return ','.join('' if math.isnan(value) else f'{value:.10g}' for value in values)
