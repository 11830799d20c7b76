"""A node's process: runs it until the session is over or a signal comes, and returns the exit status."""

from __future__ import annotations

import itertools
import os
import sys
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy._rclpy_pybind11 import RCLError, UnknownROSArgsError  # they have no public type
from rclpy.experimental import EventsExecutor
from rclpy.signals import SignalHandlerOptions, uninstall_signal_handlers

from kapitsa_ros.errors import FAILED, KapitsaError, shorten
from kapitsa_ros.ros.arguments import beside_ros, split_parent
from kapitsa_ros.ros.errors import SettingError
from kapitsa_ros.ros.log_files import without_log_files
from kapitsa_ros.ros.parameters import unknown_parameters
from kapitsa_ros.ros.rclpy_errors import first_line, is_of_rclpy, no_node_text
from kapitsa_ros.ros.reachability import refuse_unreachable
from kapitsa_ros.ros.shutdown import ShutdownWatchdog
from kapitsa_ros.ros.signals import hold_signals_back, ignore_signals, let_signals_through

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.ros.dataflow_node import DataflowNode

PATIENCE = 1.0
"""Seconds given to DDS to take a node down."""


def run(arguments: list[str], create: Callable[[], DataflowNode]) -> int:
    """Run a node until its session is over, a signal comes or its parent is gone.

    Parameters
    ----------
    arguments
        The role, and what follows it.
    create
        Makes the node, once ROS is initialised.

    Returns
    -------
    int
        The exit status.

    """
    arguments, parent = split_parent(arguments)
    role = arguments[0]
    status, node, executor, watchdog = FAILED, None, None, None
    try:
        _start(arguments)
        node = _create(create)
        try:
            executor = EventsExecutor()
            executor.add_node(node)
            _spin(node, executor, parent)
        finally:
            node.close()
        status = 0
    except (KapitsaError, OSError) as error:
        if node is None:
            status = getattr(error, 'exit_status', FAILED)
        else:  # what a node meets at work is a failure, whatever was given to it
            node.fail(error)
        print(f'{role}: error: {shorten(str(error))}', file=sys.stderr, flush=True)
    except Exception as error:  # noqa: BLE001  # a defect: nobody else would show it before the node is taken down
        # A signal shuts the context under whatever call is being made, and each complains in its own way.
        if is_of_rclpy(error) and not rclpy.ok():
            status = 0
        else:
            if node is not None:
                node.fail(error)
            traceback.print_exc()
    finally:
        uninstall_signal_handlers()  # no context does that, and beside those of another the next run would have none
        hold_signals_back()
        if node is not None:
            watchdog = ShutdownWatchdog(PATIENCE, status)
            if executor is not None:
                executor.remove_node(node)
                executor.shutdown()
                executor = None  # in the destructor of one that outlives its context C++ aborts
            node.destroy_node()
        rclpy.try_shutdown()
        if watchdog is not None:
            watchdog.disarm()
        ignore_signals()
    return status


def _start(arguments: list[str]) -> None:
    """Hand the ROS arguments over; what rcl cannot parse is named in one line, and not in its own ten."""
    if own := beside_ros(arguments):
        raise SettingError(f'argument {own[0]} is unknown: parameters are given as --ros-args -p NAME:=VALUE')
    for option, value in itertools.pairwise(arguments):
        if option == '--params-file' and not Path(value).is_file():
            raise SettingError(f'--params-file {value}: there is no such file')
    refuse_unreachable()
    hold_signals_back()
    try:
        rclpy.init(args=[*arguments, *without_log_files()], signal_handler_options=SignalHandlerOptions.NO)
    except (RCLError, UnknownROSArgsError) as error:
        raise SettingError(f'ROS arguments: {first_line(error)}') from error


def _create(create: Callable[[], DataflowNode]) -> DataflowNode:
    try:
        node = create()
    except RCLError as error:
        if not rclpy.ok():
            raise
        raise SettingError(no_node_text(error)) from error
    # To find out where its first line comes from costs a logger 20 ms, which a run would have to wait for.
    for line in unknown_parameters(node):
        node.get_logger().warning(line)
    node.get_logger().info(f'joins domain {node.context.get_domain_id()}')
    # Not before: a signal would shut the context between a line on stderr and the same line on rosout.
    let_signals_through()
    return node


def _spin(node: DataflowNode, executor: Any, parent: int | None) -> None:
    try:
        # The executor's own spin() busy-loops in these wheels; spin_once with a time-out does not.
        while not node.finished and rclpy.ok() and parent in (None, os.getppid()):
            executor.spin_once(timeout_sec=node.poll())
    finally:
        del executor  # which the traceback of an exception would keep alive
