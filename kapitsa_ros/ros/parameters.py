"""Declared, described, range-checked parameters."""

from __future__ import annotations

import json
import platform
from dataclasses import asdict, fields
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterUninitializedException,
)
from rclpy.parameter import Parameter

from kapitsa_ros.instruments.errors import InstrumentError
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.ros.errors import SettingError

if TYPE_CHECKING:
    from rclpy.node import Node

TINY, HUGE = 1e-6, 1e6
_PLANT = {
    'length': ('L: length of the uniform rod, m', TINY, 1e3),
    'amplitude': ('lambda: amplitude of the pivot, half its stroke, m', TINY, 1e2),
    'gravity': ('g, m/s^2', TINY, 1e3),
    'damping': ('c = 3 mu/(m L^2): viscous friction, 1/s', 0.0, HUGE),
    'coulomb': ('f = 3 phi/(m L^2): Coulomb friction, rad/s^2', 0.0, HUGE),
    'clearance': ('D: diametral play of the pivot hole, m', 0.0, 1.0),
    'restitution': ('e: restitution of impacts within the play', 0.0, 1.0),
    'inertia_factor': ('kappa: k = kappa 3/(2L); 1 is the ideal rod', TINY, 1e3),
    'wear': ('growth of the clearance, m per J/kg that impacts lose', 0.0, 1.0),
    'failure_clearance': ('play at which the hole has worn through, m', TINY, 1.0),
}


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
    descriptor = ParameterDescriptor(description=description, read_only=read_only)
    if low is not None and high is not None:
        if isinstance(default, float):
            descriptor.floating_point_range = [FloatingPointRange(from_value=low, to_value=high)]
        else:
            descriptor.integer_range = [IntegerRange(from_value=low, to_value=high)]
    try:
        return node.declare_parameter(name, default, descriptor).value
    except InvalidParameterTypeException as error:
        wanted = Parameter('', value=default).type_.name.lower()
        hint = ': write 1.0 for 1' if isinstance(default, float) else ''
        raise SettingError(f'parameter {name} must be a {wanted}{hint} ({error})') from error
    except InvalidParameterValueException as error:
        given = next((p.value for p in [node._parameter_overrides.get(name)] if p), default)  # noqa: SLF001
        bounds = f' in [{low}, {high}]' if low is not None else ''
        raise SettingError(f'parameter {name} is {given}: it must be a finite value{bounds}') from error
    except ParameterUninitializedException as error:
        raise SettingError(str(error)) from error


def declare_plant(node: Node, *names: str) -> Plant:
    """Declare the named fields of the plant as parameters and return the plant they make."""
    defaults = Plant()
    values = {name: declare(node, name, getattr(defaults, name), *_PLANT[name]) for name in names}
    try:
        return Plant(**values)
    except PhysicsError as error:
        raise SettingError(f'parameter {error}') from error


def declare_settings(node: Node, kind: Any) -> Any:
    """Declare the fields of an instrument's settings as parameters and return the settings they make."""
    values = {
        field.name: declare(
            node,
            field.name,
            field.default,
            field.metadata['description'],
            field.metadata['low'],
            field.metadata['high'],
        )
        for field in fields(kind)
    }
    try:
        return kind(**values)
    except InstrumentError as error:
        raise SettingError(f'parameter {error}') from error


def declare_seed(node: Node) -> int:
    """Declare the one seed from which every instrument draws a stream of its own."""
    return int(declare(node, 'seed', 1, 'of all chance in the rig', 0, 2**63 - 1))


def versions() -> dict[str, str]:
    """Return the versions on which the numbers of a run depend."""
    names = ('kapitsa_ros', 'numpy', 'scipy', 'numba')
    return {'python': platform.python_version()} | {name: version(name) for name in names}


def settings_text(node: str, **settings: Any) -> str:
    """Return the settings of a node as they are latched and recorded: JSON with sorted keys."""
    plain = {key: asdict(value) if hasattr(value, '__dataclass_fields__') else value for key, value in settings.items()}
    return json.dumps({'node': node} | plain, sort_keys=True)
