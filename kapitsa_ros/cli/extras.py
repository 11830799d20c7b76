"""Parts of the package that stand on packages which not everybody has."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from kapitsa_ros.rig.errors import RigError


def from_extra(module: str, extra: str) -> Any:
    """Return a module.

    Parameters
    ----------
    module
        Its name.
    extra
        That brings what it imports.

    Raises
    ------
    RigError
        A package is not installed.

    """
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        raise RigError(
            f'the bench needs {error.name}: run `make setup`, or pip install "kapitsa_ros[{extra}]"'
        ) from error
