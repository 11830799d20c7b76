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
        raise PageRequestError('there is no request {name!r}', name=name[:_LONGEST_TEXT])
    if unknown := content.keys() - {'do', 'value'}:
        raise PageRequestError('{name}: {unknown!r} is not understood', name=name, unknown=min(unknown)[:_LONGEST_TEXT])
    return PageRequest(name, _value(name, content.get('value')))


def _value(name: str, value: Any) -> Any:
    kinds = _VALUES[name]
    if not kinds:
        if value is not None:
            raise PageRequestError('{name}: takes no value', name=name)
        return None
    if kinds == (dict,):
        if not isinstance(value, dict) or len(value) > _MOST_NAMES:
            raise PageRequestError('{name}: needs {most} values by their names', name=name, most=_MOST_NAMES)
        return {each[:_LONGEST_TEXT]: _checked(name, item, (str, float)) for each, item in value.items()}
    return _checked(name, value, kinds)


def _checked(name: str, value: Any, kinds: tuple[type, ...]) -> Any:
    number: Any = value
    if isinstance(value, bool) or not isinstance(value, (*kinds, *((int,) if float in kinds else ()))):
        if kinds == (int,):
            raise PageRequestError('{name}: needs a whole number', name=name)
        raise PageRequestError('{name}: needs a number', name=name)
    if isinstance(value, str):
        if len(value) > _LONGEST_TEXT:
            raise PageRequestError('{name}: longer than {most} characters', name=name, most=_LONGEST_TEXT)
        return value.strip()
    if not -_LARGEST < number < _LARGEST:
        raise PageRequestError('{name}: no number that can be meant', name=name)
    return value


def _refuse_constant(name: str) -> NoReturn:
    raise PageRequestError('{name} is no number', name=name)
