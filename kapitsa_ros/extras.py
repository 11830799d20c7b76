"""Modules that stand on packages of an extra, which may not be installed."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from kapitsa_ros.errors import MissingPackageError, UnreadableSettingsError


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
    UnreadableSettingsError
        A package reads settings of the user's as it is loaded, and cannot.

    """
    try:
        return import_module(module)
    except UnicodeDecodeError as error:
        raise UnreadableSettingsError(
            f'{use} needs {module}, which does not load: a file of settings that it reads, as a matplotlibrc in the '
            'current folder, is no UTF-8; write it anew, or move it away'
        ) from error
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition('.')[0] == __name__.partition('.')[0]:
            raise
        raise MissingPackageError(
            f'{use} needs {error.name}: run `make setup`, or pip install "kapitsa_ros[{extra}]"'
        ) from error
