"""One node as a process: it runs until its session is over or a signal comes."""

from __future__ import annotations

import itertools
import os
import sys
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import rclpy
from rclpy._rclpy_pybind11 import (  # a params file that cannot be parsed has no public type
    RCLError,
    UnknownROSArgsError,
)
from rclpy.exceptions import NotInitializedException
from rclpy.executors import ExternalShutdownException
from rclpy.experimental import EventsExecutor

from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.network.registry import NODE_NAMES
from kapitsa_ros.ros.errors import SettingError
from kapitsa_ros.ros.shutdown import exit_within
from kapitsa_ros.ros.signals import hold_signals_back, ignore_signals, let_signals_through

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.ros.dataflow_node import DataflowNode

PATIENCE = 1.0
"""Seconds given to DDS to take a node down."""


def main(arguments: list[str] | None = None) -> int:
    """Run the node named first; what follows are ROS arguments. Return the exit status."""
    arguments = sys.argv[1:] if arguments is None else arguments
    if not arguments or arguments[0] not in NODE_NAMES:
        given = repr(arguments[0]) if arguments else 'none'
        print(f'kapitsa: error: node {given} is unknown: choose one of {", ".join(NODE_NAMES)}', file=sys.stderr)
        return 2
    role = arguments[0]
    module = import_module(f'kapitsa_ros.nodes.{role}')
    if {'-h', '--help'} & set(_beside_ros(arguments)):
        print(f'usage: {role} [--ros-args -p PARAMETER:=VALUE ... --params-file FILE ...]\n\n{module.__doc__}')
        return 0
    status, node = 1, None
    try:
        _start(arguments)
        node = _create(module.create)
        _spin(node)
        status = 0
    except SettingError as error:
        status = _complain(role, error, 2)
    except (KapitsaError, ValueError, OSError) as error:
        if node is not None:
            node.fail(error)
        status = _complain(role, error, 1)
    except (ExternalShutdownException, NotInitializedException, RuntimeError):
        # A signal shuts the context under whatever call is being made, and each complains in its own way.
        if rclpy.ok():
            raise
        status = 0
    finally:
        hold_signals_back()
        if node is not None:
            _take_down(node, status)
        rclpy.try_shutdown()
        ignore_signals()
    return status


def _complain(role: str, error: Exception, status: int) -> int:
    print(f'{role}: error: {error}', file=sys.stderr, flush=True)
    return status


def _beside_ros(arguments: list[str]) -> list[str]:
    return arguments[1 : arguments.index('--ros-args') if '--ros-args' in arguments else None]


def _start(arguments: list[str]) -> None:
    """Hand the ROS arguments over; what rcl cannot parse is named in one line, and not in its own ten."""
    if own := _beside_ros(arguments):
        raise SettingError(f'argument {own[0]} is unknown: parameters are given as --ros-args -p NAME:=VALUE')
    for option, value in itertools.pairwise(arguments):
        if option == '--params-file' and not Path(value).is_file():
            raise SettingError(f'--params-file {value}: there is no such file')
    hold_signals_back()
    try:
        rclpy.init(args=arguments)
    except (RCLError, UnknownROSArgsError) as error:
        raise SettingError(f'ROS arguments: {str(error).splitlines()[0]}') from error
    let_signals_through()


def _create(create: Callable[[], DataflowNode]) -> DataflowNode:
    try:
        node = create()
    except RCLError as error:
        if not rclpy.ok():
            raise
        domain = os.environ.get('ROS_DOMAIN_ID', 'unset')
        raise SettingError(f'no node can be made, ROS_DOMAIN_ID is {domain}: {str(error).splitlines()[0]}') from error
    # To find out where its first line comes from costs a logger 20 ms, which a run would have to wait for.
    node.get_logger().info(f'joins domain {node.context.get_domain_id()}')
    return node


def _spin(node: DataflowNode) -> None:
    executor = EventsExecutor()
    executor.add_node(node)
    try:
        # The executor's own spin() busy-loops in these wheels; spin_once with a time-out does not.
        while not node.finished and rclpy.ok() and _rig_is_there():
            executor.spin_once(timeout_sec=node.poll())
    finally:
        try:
            node.close()
        finally:
            executor.shutdown()


def _take_down(node: DataflowNode, status: int) -> None:
    """Let go of the node: DDS tells the others, and may hang after that."""
    exit_within(PATIENCE, status)
    node.destroy_node()


def _rig_is_there() -> bool:
    """Whether the process that started this one as part of a rig, if one did, still runs."""
    return os.environ.get('KAPITSA_RIG_PID', str(os.getppid())) == str(os.getppid())
