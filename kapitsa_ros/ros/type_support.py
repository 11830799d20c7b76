"""The libraries of messages and services, loaded before a node is made.

rclpy loads them with the first publisher, subscription or service of a type; a process that nodes are forked from can
do it once for all.
"""

from __future__ import annotations

import ctypes
import sys
import warnings
from contextlib import suppress
from importlib import import_module
from itertools import product
from typing import TYPE_CHECKING

from rclpy.type_support import check_for_type_support
from rclpy.utilities import get_rmw_implementation_identifier

if TYPE_CHECKING:
    from collections.abc import Iterable

_GENERATOR = 'rosidl_generator_py'
OF_EVERY_NODE = (
    'diagnostic_msgs/msg/DiagnosticArray',
    'rcl_interfaces/msg/Log',
    'rcl_interfaces/msg/ParameterEvent',
    'rcl_interfaces/srv/DescribeParameters',
    'rcl_interfaces/srv/GetParameters',
    'rcl_interfaces/srv/GetParameterTypes',
    'rcl_interfaces/srv/ListParameters',
    'rcl_interfaces/srv/SetParameters',
    'rcl_interfaces/srv/SetParametersAtomically',
    'std_msgs/msg/String',
    'type_description_interfaces/srv/GetTypeDescription',
)
"""Besides those of its own topics: most are of rclpy."""
OF_THOSE_THAT_KEEP_TIME = ('rosgraph_msgs/msg/Clock', 'sensor_msgs/msg/JointState', 'std_srvs/srv/Trigger')
"""Of jigsaw, player and pendulum besides."""


def load_generator() -> None:
    """Load what rclpy loads with the first type of a process.

    Its parser imports modules that Python has deprecated: a program that takes warnings for errors, as many test suites
    are set to, could have no node.
    """
    if _GENERATOR not in sys.modules:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore', DeprecationWarning)
            import_module(_GENERATOR)


def load_type_supports(types: Iterable[str]) -> None:
    """Load what Python and the middleware need for types such as `std_msgs/msg/Header` or `std_srvs/srv/Trigger`."""
    types = tuple(types)
    load_generator()
    for package, kind, name in (each.split('/') for each in types):
        check_for_type_support(getattr(import_module(f'{package}.{kind}'), name))
    if get_rmw_implementation_identifier().startswith('rmw_fastrtps'):
        for package, use in product({each.split('/')[0] for each in types}, ('fastrtps', 'introspection')):
            with suppress(OSError):  # it is loaded with the first node then
                ctypes.CDLL(f'lib{package}__rosidl_typesupport_{use}_c.so')
