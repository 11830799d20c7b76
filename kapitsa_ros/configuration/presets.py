"""Presets: plants by name or file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.configuration.files import find_file, read_parameters
from kapitsa_ros.physics.errors import ParameterError
from kapitsa_ros.physics.plant import Plant

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

FOLDER = 'presets'


def load_preset(name: str | Path, overrides: Mapping[str, Any] | None = None) -> Plant:
    """Read a preset, by its name in config/presets or the path of a file, and replace the given parameters.

    Raises
    ------
    ParameterError
        There is no such preset, or a parameter is unknown or out of its range.

    """
    path = find_file(FOLDER, name, ParameterError)
    parameters = read_parameters(path, ParameterError)
    try:
        plant = Plant.of(parameters)
    except ParameterError as error:
        raise ParameterError(f'{path}: {error}') from error
    return plant.replaced(overrides or {})
