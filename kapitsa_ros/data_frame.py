"""Columns as objects of pandas and xarray, which come with an extra."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.errors import MissingPackageError

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd
    import xarray as xr


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


def dataset(variables: Mapping[str, tuple[str, Any, dict[str, Any]]], attributes: Mapping[str, Any]) -> xr.Dataset:
    """Return variables by name, each with its dimension, values and attributes, as a dataset.

    Raises
    ------
    MissingPackageError
        Xarray is not installed.

    """
    try:
        import xarray as xr  # noqa: PLC0415
    except ImportError as error:
        raise MissingPackageError('a dataset needs xarray: pip install xarray, or "kapitsa_ros[report]"') from error
    return xr.Dataset(dict(variables), attrs=dict(attributes))
