"""Tables of readings by name or file."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.analysis.table import PERIOD_SIGMA, Readings
from kapitsa_ros.configuration.files import find_file
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

FOLDER = 'tables'
_REQUIRED = ('forcing_rpm', 'period_s')
_OPTIONAL = {'forcing_sigma_rpm': 0.0, 'period_sigma_s': PERIOD_SIGMA}


def load_table(name: str | Path) -> Readings:
    """Read a table, by its name in config/tables or the path of a file: see `read_table`.

    Raises
    ------
    TableError
        There is no such table, or it is none that runs can give.

    """
    return read_table(find_file(FOLDER, name, TableError))


def read_table(path: Path) -> Readings:
    """Read a CSV table with the columns forcing_rpm, period_s and, where known, forcing_sigma_rpm, period_sigma_s.

    Raises
    ------
    TableError
        The file is no such table, or its values are none that runs can have.

    """
    try:
        with path.open(encoding='utf-8-sig', newline='') as file:
            reader = csv.DictReader((line for line in file if line.strip() and not line.startswith('#')), strict=True)
            names = [name.strip() for name in reader.fieldnames or []]
            reader.fieldnames = names
            rows = list(reader)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise TableError(f'{path}: cannot be read as CSV ({error})') from error
    _check_header(path, names)
    surplus = next((number for number, row in enumerate(rows, start=1) if None in row), None)
    if surplus is not None:
        raise TableError(f'{path}: row {surplus} has more values than there are columns: write decimals with a point')
    columns = {name: _column(path, rows, name, None) for name in _REQUIRED}
    columns |= {name: _column(path, rows, name, default) for name, default in _OPTIONAL.items()}
    try:
        return Readings(
            forcing=columns['forcing_rpm'] * RPM,
            period=columns['period_s'],
            forcing_sigma=columns['forcing_sigma_rpm'] * RPM,
            period_sigma=columns['period_sigma_s'],
        )
    except TableError as error:
        raise TableError(f'{path}: {error}') from error


def _check_header(path: Path, names: list[str]) -> None:
    missing = [name for name in _REQUIRED if name not in names]
    if missing:
        hint = ' and separate columns by commas' if len(names) == 1 else ''
        raise TableError(
            f'{path}: no column {", ".join(missing)} (found: {", ".join(names) or "none"}): '
            f'name the columns in the first line{hint}'
        )
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise TableError(f'{path}: more than one column {", ".join(twice)}: leave one')


def _column(path: Path, rows: list[dict[str, str]], name: str, default: float | None) -> NDArray[np.float64]:
    values = []
    for number, row in enumerate(rows, start=1):
        text = (row.get(name) or '').strip()
        if not text and default is not None:
            values.append(default)
            continue
        try:
            values.append(float(text))
        except ValueError as error:
            raise TableError(f'{path}: row {number}: {name} is {text!r}: give a plain number') from error
    return np.array(values, dtype=np.float64)
