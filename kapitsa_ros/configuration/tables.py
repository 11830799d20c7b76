"""Tables of timings by name or file."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, NoReturn, cast, get_args

import numpy as np

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.analysis.evidence import evidence_of
from kapitsa_ros.analysis.table import PERIOD_SIGMA, Readings, refuse_mixed_units
from kapitsa_ros.analysis.timing_row import TimingRow
from kapitsa_ros.configuration.files import find_file
from kapitsa_ros.errors import shorten
from kapitsa_ros.network.timing import Kind
from kapitsa_ros.output_file import replacing
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

FOLDER = 'tables'
COLUMNS = (
    'forcing_rpm', 'period_s', 'forcing_sigma_rpm', 'period_sigma_s', 'speed_asked_rpm', 'forcing_read_rpm', 'alias',
    'release_rad', 'kind', 'swings', 'display_s', 'time_s', 'run',
)  # fmt: skip
"""Of a table; the first two are required, the others may be left out."""
_REQUIRED = COLUMNS[:2]
_MOST_NAMES, _LONGEST_NAME = 6, 40
"""Of the columns that an error lists."""


@dataclass(frozen=True, kw_only=True)
class TimingTable:
    """The rows of a table, and what in it was not used."""

    rows: tuple[TimingRow, ...]
    warnings: tuple[str, ...] = ()

    @property
    def readings(self) -> Readings:
        """Speeds and periods of what was timed."""
        return evidence_of(self.rows).timed


def table_of(readings: Readings) -> TimingTable:
    """Return a table of speeds and periods of which nothing else is known."""
    columns = (readings.forcing, readings.forcing_sigma, readings.period, readings.period_sigma)
    rows = zip(*(column.tolist() for column in columns), strict=True)
    return TimingTable(
        rows=tuple(
            TimingRow(kind='timed', speed=speed, speed_sigma=speed_sigma, period=period, period_sigma=period_sigma)
            for speed, speed_sigma, period, period_sigma in rows
        )
    )


def load_timings(name: str | Path) -> TimingTable:
    """Read a table, by its name in config/tables or the path of a file: see `read_timings`.

    Raises
    ------
    TableError
        There is no such table, or it is none that runs can give.

    """
    return read_timings(find_file(FOLDER, name, TableError))


def load_table(name: str | Path) -> Readings:
    """Read the speeds and periods of a table, by its name in config/tables or the path of a file.

    Raises
    ------
    TableError
        There is no such table, or it is none that runs can give.

    """
    return load_timings(name).readings


def read_timings(path: Path) -> TimingTable:
    """Read a CSV table with the columns forcing_rpm, period_s and any others of `COLUMNS`.

    Cells that a spreadsheet leaves behind, columns without a name and rows that hold nothing, count as not there.

    Raises
    ------
    TableError
        The file is no such table, or its values are none that runs can have.

    """
    try:
        with path.open(encoding='utf-8-sig', newline='') as file:
            lines = (line for line in file if line.strip() and not line.startswith('#'))
            cells = list(csv.reader(lines, strict=True))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise TableError(f'{path}: cannot be read as CSV ({error})') from error
    names = [name.strip() for name in cells[0]] if cells else []
    _check_header(path, [name for name in names if name])
    rows, number = [], 0
    for row in cells[1:]:
        texts = [text.strip() for text in row]
        if not any(texts):
            continue
        number += 1
        if any(text for text, name in zip(texts, names, strict=False) if not name) or any(texts[len(names) :]):
            raise TableError(
                f'{path}: row {number} has more values than there are columns: write decimals with a point'
            )
        rows.append(_row(path, number, dict(zip(names, texts, strict=False))))
    unknown = [name for name in names if name and name not in COLUMNS]
    warnings = (f'{path}: not read: column {_listed(unknown)}',) if unknown else ()
    return TimingTable(rows=tuple(rows), warnings=warnings)


def read_table(path: Path) -> Readings:
    """Read the speeds and periods of a table: see `read_timings`.

    Raises
    ------
    TableError
        The file is no such table, or its values are none that runs can have.

    """
    return read_timings(path).readings


def write_timings(path: Path, rows: Sequence[TimingRow]) -> None:
    """Write timings and falls as a table that `read_timings` reads back to the same; those unused become comments.

    Raises
    ------
    OSError
        The file cannot be written.

    """
    with replacing(path) as draft, draft.open('w', encoding='utf-8', newline='') as file:
        for row in rows:
            if row.unused is not None:
                file.write(f'# left out: run {row.run}, {row.kind}: {row.unused}\n')
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        writer.writerows(_cells(row) for row in rows if row.unused is None)


def _cells(row: TimingRow) -> Iterable[object]:
    values = (
        _over(row.speed, RPM), row.period, _over(row.speed_sigma, RPM),
        row.period_sigma if row.kind == 'timed' else None, _over(row.speed_asked, RPM), _over(row.speed_reading, RPM),
        row.alias, row.release, row.kind, row.swings, row.displayed, row.time, row.run,
    )  # fmt: skip
    return ('' if value is None else value for value in values)


def _over(value: float | None, unit: float) -> float | None:
    return None if value is None else value / unit


class _Cells:
    """The cells of a row, by the name of their column."""

    def __init__(self, path: Path, number: int, texts: Mapping[str, str]) -> None:
        self._row = f'{path}: row {number}'
        self._texts = texts

    def refuse(self, why: str) -> NoReturn:
        raise TableError(f'{self._row}: {why}')

    def text(self, name: str) -> str:
        return self._texts.get(name, '')

    def number(self, name: str, *, required: bool = False) -> float | None:
        text = self.text(name)
        try:
            return float(text) if text or required else None
        except ValueError:
            self.refuse(f'{name} is {text!r}: give a plain number')

    def speed(self, name: str, *, required: bool = False) -> float | None:
        found = self.number(name, required=required)
        return None if found is None else found * RPM

    def count(self, name: str) -> int | None:
        found = self.number(name)
        if found is not None and not (found.is_integer() and found >= 0.0):
            self.refuse(f'{name} is {found:g}: give a whole number')
        return None if found is None else int(found)

    def kind(self) -> Kind:
        text = self.text('kind') or 'timed'
        if text not in get_args(Kind):
            self.refuse(f'kind is {text!r}: write one of {", ".join(get_args(Kind))}')
        return cast('Kind', text)

    def alias(self) -> Fraction | None:
        text = self.text('alias')
        try:
            return Fraction(text) if text else None
        except (ValueError, ZeroDivisionError):
            self.refuse(f'alias is {text!r}: write a ratio, as in 2/3')


def _row(path: Path, number: int, texts: Mapping[str, str]) -> TimingRow:
    cells = _Cells(path, number, texts)
    kind = cells.kind()
    if kind != 'timed' and cells.text('period_s'):
        cells.refuse('a swing that was not timed has no period_s: leave it empty')
    speed, sigma = cells.speed('forcing_rpm', required=True), cells.number('period_sigma_s')
    if speed is None or not math.isfinite(speed):
        cells.refuse('a value is not finite: leave out runs that gave no reading')
    if speed <= 0.0:
        cells.refuse('the speed is zero or negative: leave out runs that gave no reading')
    row = TimingRow(
        kind=kind,
        speed=speed,
        speed_sigma=cells.speed('forcing_sigma_rpm') or 0.0,
        period=cells.number('period_s', required=kind == 'timed'),
        period_sigma=PERIOD_SIGMA if sigma is None else sigma,
        speed_asked=cells.speed('speed_asked_rpm'),
        speed_reading=cells.speed('forcing_read_rpm'),
        alias=cells.alias(),
        release=cells.number('release_rad'),
        swings=cells.count('swings'),
        displayed=cells.number('display_s'),
        time=cells.number('time_s'),
        run=cells.count('run'),
    )
    if row.kind == 'timed':
        values = (row.speed, row.period, row.speed_sigma, row.period_sigma)
        try:
            refuse_mixed_units(Readings(*(np.array([value], dtype=np.float64) for value in values)))
        except TableError as error:
            cells.refuse(str(error).removeprefix('row 1: '))
    return row


def _check_header(path: Path, names: list[str]) -> None:
    missing = [name for name in _REQUIRED if name not in names]
    if missing:
        hint = ' and separate columns by commas' if len(names) == 1 else ''
        found = f'numbers alone: {_listed(names)}' if names and all(map(_is_number, names)) else _listed(names)
        raise TableError(
            f'{path}: no column {", ".join(missing)} (found: {found}): name the columns in the first line{hint}'
        )
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise TableError(f'{path}: more than one column {_listed(twice)}: leave one')


def _listed(names: Sequence[str]) -> str:
    """Return names as a line can hold them: the first few, and how many more there are."""
    first = ', '.join(shorten(name, _LONGEST_NAME) for name in names[:_MOST_NAMES]) or 'none'
    return f'{first} and {len(names) - _MOST_NAMES} more' if len(names) > _MOST_NAMES else first


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
