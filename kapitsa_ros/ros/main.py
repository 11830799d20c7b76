"""A process of nodes, of one or of several: runs them until the session is over or a signal comes."""

from __future__ import annotations

import itertools
import sys
import traceback
from pathlib import Path
from typing import TYPE_CHECKING

import rclpy
from rclpy._rclpy_pybind11 import RCLError, UnknownROSArgsError  # they have no public type
from rclpy.signals import SignalHandlerOptions, uninstall_signal_handlers

from kapitsa_ros.errors import FAILED, KapitsaError, shorten
from kapitsa_ros.ros.arguments import beside_ros, split_parent, typed_parameters
from kapitsa_ros.ros.composition import Composition
from kapitsa_ros.ros.context import refuse_second_context
from kapitsa_ros.ros.errors import SettingError
from kapitsa_ros.ros.log_files import without_log_files
from kapitsa_ros.ros.log_output import refuse_unknown_switches
from kapitsa_ros.ros.network_interfaces import wait_for_network_interfaces
from kapitsa_ros.ros.output_port import hold_output_port
from kapitsa_ros.ros.params_file import read_params_file
from kapitsa_ros.ros.rclpy_errors import first_line, is_of_rclpy, security_text
from kapitsa_ros.ros.reachability import refuse_unreachable
from kapitsa_ros.ros.signals import hold_signals_back, ignore_signals, let_signals_through
from kapitsa_ros.ros.type_support import load_generator

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kapitsa_ros.ros.process_node import ProcessNode


def run(arguments: list[str], create: Callable[[], ProcessNode]) -> int:
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
    return run_composed(arguments, {arguments[0]: create})


def run_composed(arguments: list[str], creates: Mapping[str, Callable[[], ProcessNode]]) -> int:
    """Run several nodes in this process until all have finished, one fails, a signal comes or its parent is gone.

    Parameters
    ----------
    arguments
        A name for them all, and what follows it.
    creates
        What makes each node, once ROS is initialised, by its role.

    Returns
    -------
    int
        The exit status: that of the node that failed.

    """
    arguments, parent = split_parent(arguments)
    try:
        refuse_second_context()
    except SettingError as error:
        print(f'{arguments[0]}: error: {error}', file=sys.stderr, flush=True)
        return error.exit_status
    composition = Composition(creates, typed_parameters(arguments))
    status = FAILED
    try:
        _start(arguments)
        composition.make()
        # Not before: a signal would shut the context between a line on stderr and the same line on rosout.
        let_signals_through()
        composition.spin(parent)
        status = 0
    except (KapitsaError, OSError) as error:
        if not composition.is_at_work:  # what a node meets at work is a failure, whatever was given to it
            status = getattr(error, 'exit_status', FAILED)
        composition.fail(error)
        print(f'{composition.role}: error: {shorten(str(error))}', file=sys.stderr, flush=True)
    except Exception as error:  # noqa: BLE001  # a defect: nobody else would show it before the node is taken down
        # A signal shuts the context under whatever call is being made, and each complains in its own way.
        if is_of_rclpy(error) and not rclpy.ok():
            status = 0
        else:
            composition.fail(error)
            traceback.print_exc()
            if len(creates) > 1:
                print(f'{composition.role}: error: {error!r}', file=sys.stderr, flush=True)
    finally:
        uninstall_signal_handlers()  # no context does that, and beside those of another the next run would have none
        hold_signals_back()
        composition.take_down(status)
        ignore_signals()
    return status


def _start(arguments: list[str]) -> None:
    """Hand the ROS arguments over; what rcl cannot parse is named in one line, and not in its own ten."""
    if own := beside_ros(arguments):
        raise SettingError(f'argument {own[0]} is unknown: parameters are given as --ros-args -p NAME:=VALUE')
    for option, value in itertools.pairwise(arguments):
        if option == '--params-file':
            try:
                read_params_file(Path(value))
            except SettingError as error:
                raise SettingError(f'--params-file {error}') from error
    refuse_unknown_switches()
    refuse_unreachable()
    wait_for_network_interfaces()
    hold_output_port()
    load_generator()
    hold_signals_back()
    try:
        rclpy.init(args=[*arguments, *without_log_files()], signal_handler_options=SignalHandlerOptions.NO)
    except UnknownROSArgsError as error:
        raise SettingError(f'ROS arguments: unknown: {error}') from error
    except RCLError as error:
        raise SettingError(security_text(error) or f'ROS arguments: {first_line(error)}') from error
