"""Columns of numbers written to a file, its kind told by its name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.rig.errors import UsageError

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

SUFFIXES = '.csv, .npz or .parquet'


def write_table(path: Path, columns: dict[str, NDArray[np.float64]]) -> None:
    """Write columns of one length with all their digits.

    Raises
    ------
    UsageError
        The name has another suffix, or Parquet is asked for where pyarrow is not installed.

    """
    if path.suffix == '.csv':
        rows = np.column_stack(list(columns.values()))
        np.savetxt(path, rows, fmt='%.17g', delimiter=',', header=','.join(columns), comments='')
    elif path.suffix == '.npz':
        np.savez(path, **columns)  # type: ignore[arg-type]  # the stub takes the columns for allow_pickle
    elif path.suffix == '.parquet':
        _write_parquet(path, columns)
    else:
        raise UsageError(f'--output {path.name}: the name must end in {SUFFIXES}')


def _write_parquet(path: Path, columns: dict[str, NDArray[np.float64]]) -> None:
    try:
        import pyarrow as pa  # type: ignore[import-not-found,import-untyped,unused-ignore]  # noqa: PLC0415
        from pyarrow import parquet  # type: ignore[import-not-found,import-untyped,unused-ignore]  # noqa: PLC0415
    except ImportError as error:
        raise UsageError('--output: Parquet needs pyarrow: run `make setup`, or choose .csv or .npz') from error
    parquet.write_table(pa.table(columns), path)
