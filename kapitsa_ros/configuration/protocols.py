"""Protocols by name or file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.configuration.files import find_file, read_mapping
from kapitsa_ros.operator.errors import ProtocolError
from kapitsa_ros.operator.protocol import Protocol
from kapitsa_ros.units import parse_speed

if TYPE_CHECKING:
    from pathlib import Path

FOLDER = 'protocols'


def load_protocol(name: str | Path) -> Protocol:
    """Read a protocol, by its name in config/protocols or the path of a file; a bare speed is in RPM there.

    Raises
    ------
    ProtocolError
        There is no such protocol, or it says something it should not.

    """
    path = find_file(FOLDER, name, ProtocolError)
    values = read_mapping(path, ProtocolError)
    if not isinstance(values.get('speeds'), list):
        raise ProtocolError(f'{path}: a protocol has a list of speeds, as in `speeds: [2240 rpm, 2640 rpm]`')
    try:
        return Protocol.of(values | {'speeds': tuple(parse_speed(speed) for speed in values['speeds'])})
    except ValueError as error:
        raise ProtocolError(f'{path}: {error}') from error
