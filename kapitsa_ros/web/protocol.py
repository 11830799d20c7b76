"""What a page may ask for: one JSON object a frame."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, NoReturn

from kapitsa_ros.web.errors import PageRequestError

LARGEST_FRAME = 1024
"""Bytes."""
_LONGEST_TEXT = 40
_LARGEST = 1e9
_MOST_NAMES = 3
_VALUES: dict[str, tuple[type, ...]] = {
    'speed': (str, float),
    'dial': (str, float),
    'touch': (float,),
    'angle': (str, float),
    'release': (),
    'images': (int,),
    'swings': (int,),
    'watch': (float,),
    'clear': (),
    'write': (),
    'strike': (int,),
    'pause': (),
    'step': (),
    'pace': (float,),
    'next-run': (),
    'rig-readings': (),
    'look': (),
    'repair': (),
    'hand-in': (dict,),
}
"""Requests by name, and what their value may be; an int counts as a float too."""


@dataclass(frozen=True)
class PageRequest:
    """Something a page asks for."""

    name: str
    value: Any = None
    """A finite number, a short text, None, or a few numbers or texts by name."""


def parse_request(frame: str) -> PageRequest:
    """Read a frame.

    Raises
    ------
    PageRequestError
        It is no request; the message says what is wrong.

    """
    try:
        content = json.loads(frame, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        if isinstance(error, PageRequestError):
            raise
        raise PageRequestError('a request is a JSON object') from error
    if not isinstance(content, dict) or not isinstance(name := content.get('do'), str):
        raise PageRequestError('a request is a JSON object with "do" and, where it needs one, "value"')
    if name not in _VALUES:
        raise PageRequestError(f'there is no request {name[:_LONGEST_TEXT]!r}')
    if unknown := content.keys() - {'do', 'value'}:
        raise PageRequestError(f'{name}: {min(unknown)[:_LONGEST_TEXT]!r} is not understood')
    return PageRequest(name, _value(name, content.get('value')))


def _value(name: str, value: Any) -> Any:
    kinds = _VALUES[name]
    if not kinds:
        if value is not None:
            raise PageRequestError(f'{name}: takes no value')
        return None
    if kinds == (dict,):
        if not isinstance(value, dict) or len(value) > _MOST_NAMES:
            raise PageRequestError(f'{name}: needs {_MOST_NAMES} values by their names')
        return {each[:_LONGEST_TEXT]: _checked(name, item, (str, float)) for each, item in value.items()}
    return _checked(name, value, kinds)


def _checked(name: str, value: Any, kinds: tuple[type, ...]) -> Any:
    number: Any = value
    if isinstance(value, bool) or not isinstance(value, (*kinds, *((int,) if float in kinds else ()))):
        raise PageRequestError(f'{name}: needs a {"whole number" if kinds == (int,) else "number"}')
    if isinstance(value, str):
        if len(value) > _LONGEST_TEXT:
            raise PageRequestError(f'{name}: longer than {_LONGEST_TEXT} characters')
        return value.strip()
    if not -_LARGEST < number < _LARGEST:
        raise PageRequestError(f'{name}: no number that can be meant')
    return value


def _refuse_constant(name: str) -> NoReturn:
    raise PageRequestError(f'{name} is no number')
