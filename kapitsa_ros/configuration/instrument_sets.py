"""Instrument sets by name or file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.configuration.files import find_file, read_parameters
from kapitsa_ros.instruments.errors import SettingsError
from kapitsa_ros.instruments.settings import Instruments

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

FOLDER = 'instruments'


def load_instruments(name: str | Path, overrides: Mapping[str, Any] | None = None) -> Instruments:
    """Read a set, by its name in config/instruments or the path of a file, and replace the given parameters.

    Raises
    ------
    SettingsError
        There is no such set, or a parameter is unknown or out of its range.

    """
    path = find_file(FOLDER, name, SettingsError)
    parameters = read_parameters(path, SettingsError)
    try:
        instruments = Instruments.of(parameters, name=path.stem)
    except SettingsError as error:
        raise SettingsError(f'{path}: {error}') from error
    return instruments.replaced(overrides or {})
