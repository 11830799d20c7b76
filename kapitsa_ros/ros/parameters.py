"""Declared, described, range-checked parameters."""

from __future__ import annotations

import json
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, TypeVar

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterUninitializedException,
)
from rclpy.parameter import Parameter

from kapitsa_ros.configuration.playback_parameters import PlaybackParameters
from kapitsa_ros.configuration.rig_parameters import RigParameters
from kapitsa_ros.configuration.step_parameters import StepParameters
from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.operator.protocol import Protocol
from kapitsa_ros.physics.jigsaw_parameters import JigsawParameters
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.ros.errors import SettingError
from kapitsa_ros.schema import ParameterSet, describe, description_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rclpy.node import Node


_LEAST = 1e-6
"""Stands for "above 0" in a range of ROS, which contains its ends."""
_OF_ROLES = {
    'expect', 'protocol', 'release', 'steps', 'bags', 'storage', 'compression', 'steps_a_chunk',
    'start_type_description_service', 'loop', 'start_paused',
    *(item.name for kind in (Plant, JigsawParameters, StepParameters, RigParameters) for item in describe(kind)),
    *(item.name for kind in (StrobeSettings, StopwatchSettings) for item in describe(kind)),
    *(item.name for kind in (Protocol, PlaybackParameters) for item in describe(kind)),
}  # fmt: skip
"""Parameters of any role: nodes of a rig are given all of them, and each takes its own."""
_Set = TypeVar('_Set', bound=ParameterSet)


@dataclass(frozen=True)
class Declaration:
    """A parameter as a node declares it."""

    name: str
    description: str
    default: Any
    low: float | None
    high: float | None


_noted: list[list[Declaration]] = []
"""Where declarations are noted: the lists of the contexts under way."""


@contextmanager
def noting_declarations() -> Iterator[list[Declaration]]:
    """Yield a list to which each parameter is added that is declared in the context."""
    _noted.append([])
    try:
        yield _noted[-1]
    finally:
        _noted.pop()


def declare(  # noqa: PLR0917
    node: Node,
    name: str,
    default: Any,
    description: str,
    low: float | None = None,
    high: float | None = None,
    *,
    read_only: bool = True,
) -> Any:
    """Declare a parameter and return its value.

    Raises
    ------
    SettingError
        It was given a value of another type or outside [low, high].

    """
    for notes in _noted:
        notes.append(Declaration(name, description, default, low, high))
    descriptor = ParameterDescriptor(description=description, read_only=read_only)
    if low is not None and high is not None:
        if isinstance(default, float):
            descriptor.floating_point_range = [FloatingPointRange(from_value=low, to_value=high)]
        else:
            descriptor.integer_range = [IntegerRange(from_value=low, to_value=high)]
    _meet_type(node, name, default)
    wanted = Parameter('', value=default).type_.name.lower().replace('_', ' ')
    article = 'an' if wanted.startswith('i') else 'a'
    try:
        value = node.declare_parameter(name, default, descriptor).value
    except InvalidParameterTypeException as error:
        hint = ': write 1.0 for 1' if isinstance(default, float) else ''
        raise SettingError(f'parameter {name} must be {article} {wanted}{hint} ({error})') from error
    except InvalidParameterValueException as error:
        given = next((p.value for p in [node._parameter_overrides.get(name)] if p), default)  # noqa: SLF001
        bounds = f' in [{low}, {high}]' if low is not None else ''
        raise SettingError(f'parameter {name} is {given}: it must be a finite value{bounds}') from error
    except ParameterUninitializedException as error:
        raise SettingError(str(error)) from error
    if value is not None:
        return value
    if isinstance(default, list):  # rcl makes nothing at all of []
        return []
    raise SettingError(f'parameter {name} is empty: it must be {article} {wanted}')


def _meet_type(node: Node, name: str, default: Any) -> None:
    """Take a whole number for the text that it is where a text is wanted, and one text for a list of one.

    YAML makes a number of `-p protocol:=1997`, and no list of `-p bags:=runs`.
    """
    overrides = getattr(node, '_parameter_overrides', {})  # no public way
    given = overrides.get(name)
    if given is None:
        return
    value = given.value
    if isinstance(default, str) and isinstance(value, int) and not isinstance(value, bool):
        overrides[name] = Parameter(name, value=str(value))
    elif isinstance(default, list) and isinstance(value, str):
        overrides[name] = Parameter(name, value=[value])


def declare_set(node: Node, kind: type[_Set], *names: str, defaults: _Set | None = None) -> _Set:
    """Declare the quantities of a parameter set, or those named, as parameters, and return the set they make.

    Parameters
    ----------
    node
        Whose parameters they are.
    kind
        The set.
    names
        Of its quantities; none: all.
    defaults
        Values of what the node is not given; None: those of the set.

    Raises
    ------
    SettingError
        A value is of another type or out of its range.

    """
    values = {
        item.name: declare_quantity(node, kind, item.name, default=getattr(defaults, item.name, None))
        for item in describe(kind)
        if item.name in names or not names
    }
    try:
        return kind(**values)
    except KapitsaError as error:
        raise SettingError(f'parameter {error}') from error


def declare_quantity(
    node: Node, kind: type[ParameterSet], name: str, *, default: float | None = None, read_only: bool = True
) -> Any:
    """Declare one quantity of a parameter set as a parameter and return its value; the default is the set's, or given.

    Raises
    ------
    SettingError
        It is of another type or out of its range.

    """
    item = next(item for item in describe(kind) if item.name == name)
    low = max(item.low, _LEAST) if item.above else item.low
    usual = item.default if default is None else default
    return declare(node, name, usual, description_of(item), low, item.high, read_only=read_only)


def unknown_parameters(node: Node, typed: frozenset[str] = frozenset()) -> list[str]:
    """Return in words which parameters a node was given that it does not have.

    Parameters
    ----------
    node
        That has declared its own.
    typed
        Names of those that were meant for this node. Of others, those of other roles are not told: a rig's file has
        all, and each node takes its own.

    """
    declared = set(node.get_parameters_by_prefix('')) | {'use_sim_time'}
    names = sorted(declared | _OF_ROLES)
    unknown = sorted(set(node._parameter_overrides) - set(names))  # noqa: SLF001  # no public way
    likely = {name: get_close_matches(name, names, n=1) for name in unknown if not name.startswith('qos_overrides.')}
    others = sorted((typed & _OF_ROLES) - declared)
    return [f'parameter {name} is that of another role: it is not used here' for name in others] + [
        f'parameter {name} is unknown{f": {close[0]} may be meant" if close else ""}' for name, close in likely.items()
    ]


def settings_text(node: str, **settings: Any) -> str:
    """Return the settings of a node as they are latched and recorded: JSON with sorted keys."""
    plain = {key: asdict(value) if hasattr(value, '__dataclass_fields__') else value for key, value in settings.items()}
    return json.dumps({'node': node} | plain, sort_keys=True)
