"""Files of parameters that nodes are given: what they have to look like, said before rcl reads them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.configuration.files import read_mapping
from kapitsa_ros.ros.errors import SettingError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_PARAMETERS = 'ros__parameters'


def read_params_file(path: Path) -> dict[str, dict[str, Any]]:
    """Return the parameters in a file, by the names of the nodes that they are for; `/**` is any.

    Tags are not looked at, as rcl does not: launch_ros writes a list as a tuple of Python's.

    Raises
    ------
    SettingError
        There is no such file, or it is one that rcl would refuse in words of its own or take for one of no parameters.

    """
    if not path.is_file():
        raise SettingError(f'{path}: there is no such file')
    return dict(_parameters('', read_mapping(path, SettingError, any_tag=True), path))


def _parameters(name: str, node: Any, path: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the nodes of a name or a namespace: each has `ros__parameters` or stands above one that has."""
    if not isinstance(node, dict):
        raise SettingError(
            f'{path}: below the name of a node, or `/**`, stands `{_PARAMETERS}:`, then names and values'
        )
    for key, value in node.items():
        if key == _PARAMETERS and isinstance(value, dict):
            yield name, value
        else:
            yield from _parameters('/'.join(filter(None, (name, str(key)))), value, path)
