"""Files of the folders below config: a shipped one by its name, or anybody's by its path."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from kapitsa_ros.bounded_yaml import load_yaml
from kapitsa_ros.resources import resource_path

if TYPE_CHECKING:
    from kapitsa_ros.errors import KapitsaError

_SUFFIXES = {'tables': '.csv'}
_YAML = '.yaml'


def shipped_names(folder: str) -> tuple[str, ...]:
    """Return the names of the files that are shipped in a folder below config, in alphabetical order."""
    suffix = _SUFFIXES.get(folder, _YAML)
    return tuple(sorted(path.stem for path in resource_path('config', folder).glob(f'*{suffix}')))


def find_file(folder: str, name: str | Path, error: type[KapitsaError]) -> Path:
    """Return the path of a shipped file, by its name, or of another, by its path.

    A shipped name comes first; with its suffix (`1997.csv`) it is a path, and the shipped file where there is none.

    Raises
    ------
    KapitsaError
        There is no such file; of the class `error`.

    """
    suffix = _SUFFIXES.get(folder, _YAML)
    shipped = {stem: resource_path('config', folder, f'{stem}{suffix}') for stem in shipped_names(folder)}
    if str(name) in shipped:
        return shipped[str(name)]
    path = Path(str(name))  # a program may have given anything
    try:
        found = path.is_file()
    except (OSError, ValueError):
        found = False  # no name a file could have
    if found:
        return path
    if path.name == str(name) and path.suffix == suffix and path.stem in shipped:
        return shipped[path.stem]
    what = folder.removesuffix('s').replace('instrument', 'instruments')
    raise error(f'no {what} {str(name)!r}: give the path of a {suffix[1:].upper()} file or one of {", ".join(shipped)}')


def read_mapping(path: Path, error: type[KapitsaError], *, any_tag: bool = False) -> dict[str, Any]:
    """Read a YAML file that holds a mapping; a tag that nobody knows is refused, unless `any_tag`.

    Raises
    ------
    KapitsaError
        It cannot be read or holds something else; of the class `error`.

    """
    try:
        document = load_yaml(path.read_text(encoding='utf-8'), any_tag=any_tag)
    except (yaml.YAMLError, UnicodeDecodeError) as cause:
        raise error(f'{path} is not YAML: {str(cause).splitlines()[0]}') from cause
    except OSError as cause:
        raise error(f'{path} cannot be read: {cause.strerror}') from cause
    if not isinstance(document, dict):
        raise error(f'{path}: give names and values, as in `length: 0.25`')
    return document


def read_parameters(path: Path, error: type[KapitsaError]) -> dict[str, Any]:
    """Read a parameter file of ROS for nodes of any name.

    Raises
    ------
    KapitsaError
        It cannot be read or holds something else; of the class `error`.

    """
    match read_mapping(path, error):
        case {'/**': {'ros__parameters': dict(parameters), **others}, **nodes} if not others and not nodes:
            return parameters
    raise error(f'{path}: write it as a params file of ROS, `/**:`, below it `ros__parameters:`, then names and values')
