"""What the operator is to do: speeds, release angle, swings to time, repeats."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import yaml

from kapitsa_ros.operator.errors import ProtocolError
from kapitsa_ros.resources import resource_path
from kapitsa_ros.units import parse_angle, parse_speed

MANUAL = 'manual'
"""In place of a protocol: the operator does what a person asks for."""
_KEYS = {'speeds', 'release', 'swings', 'repeats'}


@dataclass(frozen=True, kw_only=True)
class Protocol:
    """One run a speed; in each, `repeats` timings of `swings` full swings after a release from `release`.

    Raises
    ------
    ProtocolError
        A value is out of its range.

    """

    speeds: tuple[float, ...]
    """Forcing speeds, rad/s."""
    release: float = 0.12
    """Angle from upright at which the pendulum is let go, rad."""
    swings: int = 3
    repeats: int = 1

    def __post_init__(self) -> None:
        if not self.speeds or not all(math.isfinite(speed) and speed > 0 for speed in self.speeds):
            raise ProtocolError('speeds: give one or more positive speeds, as in [2240 rpm, 2640 rpm]')
        if not (math.isfinite(self.release) and 0 < abs(self.release) < math.pi / 2):
            raise ProtocolError(f'release: {self.release} rad is not between 0 and a quarter turn')
        for name in ('swings', 'repeats'):
            value = getattr(self, name)
            if not isinstance(value, int) or isinstance(value, bool) or not 1 <= value <= 1000:
                raise ProtocolError(f'{name}: {value!r} is not a whole number from 1 to 1000')


def load_protocol(name: str) -> Protocol:
    """Read a protocol: the name of a shipped one, or the path of a YAML file.

    Raises
    ------
    ProtocolError
        There is no such protocol, or it says something it should not.

    """
    shipped = resource_path('config', 'protocols')
    path = shipped / f'{name}.yaml'
    try:
        path = path if path.is_file() else Path(name)
        found = path.is_file()
    except OSError:
        found = False  # no name a file could have
    if not found:
        known = ', '.join(sorted(file.stem for file in shipped.glob('*.yaml')))
        raise ProtocolError(f'no protocol {name!r}: give the path of a YAML file or one of {known}')
    try:
        document = yaml.safe_load(path.read_text(encoding='utf-8'))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ProtocolError(f'{path} is not YAML: {str(error).splitlines()[0]}') from error
    if not isinstance(document, dict) or not isinstance(document.get('speeds'), list) or document.keys() - _KEYS:
        raise ProtocolError(f'{path}: a protocol has the keys {", ".join(sorted(_KEYS))}, and speeds is a list')
    try:
        values = dict(document, speeds=tuple(parse_speed(speed) for speed in document['speeds']))
        if 'release' in values:
            values['release'] = parse_angle(values['release'])
    except ValueError as error:
        raise ProtocolError(f'{path}: {error}') from error
    return Protocol(**values)
