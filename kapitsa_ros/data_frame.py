"""Columns as objects of pandas and xarray, which come with an extra."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.extras import import_of_extra

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
    frame: pd.DataFrame = import_of_extra('pandas', 'a data frame', 'report').DataFrame(dict(columns))
    return frame


def dataset(variables: Mapping[str, tuple[str, Any, dict[str, Any]]], attributes: Mapping[str, Any]) -> xr.Dataset:
    """Return variables by name, each with its dimension, values and attributes, as a dataset.

    Raises
    ------
    MissingPackageError
        Xarray is not installed.

    """
    xarray = import_of_extra('xarray', 'a dataset', 'report')
    found: xr.Dataset = xarray.Dataset(dict(variables), attrs=dict(attributes))
    return found
