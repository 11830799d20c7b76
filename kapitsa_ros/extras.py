"""Modules that stand on packages of an extra, which may not be installed."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from kapitsa_ros.errors import MissingPackageError


def import_of_extra(module: str, use: str, extra: str) -> Any:
    """Import a module that needs packages of an extra: one of theirs, or one of ours that imports them.

    Parameters
    ----------
    module
        Its full name.
    use
        What it is needed for, as the message begins.
    extra
        Name of the extra that brings the packages.

    Raises
    ------
    MissingPackageError
        A package is not installed. A module of ours that is not there is a defect, and raised as it is.

    """
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition('.')[0] == __name__.partition('.')[0]:
            raise
        raise MissingPackageError(
            f'{use} needs {error.name}: run `make setup`, or pip install "kapitsa_ros[{extra}]"'
        ) from error
