"""Output files: checked before the work, written as a whole; tables in the format that their name tells."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.errors import OPTION, OutputError
from kapitsa_ros.extras import import_of_extra
from kapitsa_ros.output_file import check_output, replacing

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    Columns = Mapping[str, NDArray[np.float64]]

SUFFIXES = '.csv, .npz or .parquet'


def check_table_output(path: Path, *, overwrite: bool = False) -> None:
    """Check that a table can be written.

    Raises
    ------
    OutputError
        It cannot be written or is there already, or its name has another suffix.
    MissingPackageError
        It needs pyarrow, which is not installed.

    """
    if path.suffix not in _WRITERS:
        raise OutputError(f'{OPTION}: the name must end in {SUFFIXES}', option='output', value=path.name)
    if path.suffix == '.parquet':
        import_of_extra('pyarrow.parquet', 'Parquet', 'report')
    check_output(path, overwrite=overwrite)


def write_table(path: Path, columns: Columns) -> None:
    """Write columns of one length with all their digits, in place of a file that is there.

    Raises
    ------
    OutputError, MissingPackageError
        As from `check_table_output`.

    """
    check_table_output(path, overwrite=True)
    with replacing(path) as draft:
        _WRITERS[path.suffix](draft, columns)


def _write_csv(path: Path, columns: Columns) -> None:
    rows = np.column_stack(list(columns.values()))
    with path.open('w', encoding='utf-8') as file:
        np.savetxt(file, rows, fmt='%.17g', delimiter=',', header=','.join(columns), comments='')


def _write_npz(path: Path, columns: Columns) -> None:
    with path.open('wb') as file:  # of a name it would make another
        np.savez(file, **columns)  # type: ignore[arg-type]  # the stub takes the columns for allow_pickle


def _write_parquet(path: Path, columns: Columns) -> None:
    table = import_of_extra('pyarrow', 'Parquet', 'report').table(dict(columns))
    with path.open('wb') as file:  # a name has to be UTF-8 there, and may be taken for an address
        import_of_extra('pyarrow.parquet', 'Parquet', 'report').write_table(table, file)


_WRITERS = {'.csv': _write_csv, '.npz': _write_npz, '.parquet': _write_parquet}
