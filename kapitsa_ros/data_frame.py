"""Columns as a data frame of pandas, which comes with an extra."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.errors import MissingPackageError

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd


def data_frame(columns: Mapping[str, Any]) -> pd.DataFrame:
    """Return columns of one length, by name, as a data frame.

    Raises
    ------
    MissingPackageError
        Pandas is not installed.

    """
    try:
        import pandas as pd  # noqa: PLC0415
    except ImportError as error:
        raise MissingPackageError('a data frame needs pandas: pip install pandas, or "kapitsa_ros[report]"') from error
    return pd.DataFrame(dict(columns))
