"""What a bag's metadata says of it: its files, how many messages they hold, and the recorder's own words."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import yaml

from kapitsa_ros.bounded_yaml import load_yaml
from kapitsa_ros.recording.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Mapping

_TOP = 'rosbag2_bagfile_information'
_LAST_VERSION = 9


@dataclass(frozen=True, kw_only=True)
class Promise:
    """What metadata says; it is checked against what can be read."""

    files: tuple[str, ...] = ()
    """Names of the storage files."""
    counts: Mapping[str, int] = field(default_factory=dict)
    """Messages by topic."""
    custom: Mapping[str, str] = field(default_factory=dict)
    """The recorder's own words by name."""


def parse_promise(text: str) -> Promise:
    """Read metadata, of version 1 to 9, as it stands in `metadata.yaml` or within a storage file.

    Raises
    ------
    BagError
        The text is no metadata of a bag; the message says why, without a name.

    """
    try:
        document = load_yaml(text)
        information = document[_TOP] if isinstance(document, dict) and _TOP in document else document
        version = information['version']
        if not isinstance(version, int) or version > _LAST_VERSION:
            raise BagError(f'its version is {version}: 1 to {_LAST_VERSION} are known')
        custom = information.get('custom_data') or {}
        return Promise(
            files=tuple(_file_name(each) for each in information['relative_file_paths']),
            counts=dict(_count(each) for each in information.get('topics_with_message_count') or ()),
            custom={str(name): str(value) for name, value in custom.items()},
        )
    except yaml.YAMLError as error:
        raise BagError(f'it is not YAML ({str(error).splitlines()[0]})') from error
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise BagError(f'it is no metadata of a bag ({error!r})') from error


def _file_name(path: Any) -> str:
    """Return the name of a file: the first versions had the name of the folder before it."""
    name = str(path).replace('\\', '/').rsplit('/', 1)[-1]
    if name in ('', '.', '..'):
        raise ValueError(f'{path!r} is no file')
    return name


def _count(entry: Any) -> tuple[str, int]:
    return str(entry['topic_metadata']['name']).removeprefix('/'), int(entry['message_count'])
