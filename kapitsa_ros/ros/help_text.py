"""What `NODE --help` prints: the parameters that the node declares, with meaning, default and range."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

import rclpy
from rclpy.signals import SignalHandlerOptions

from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.ros.arguments import COMPOSED, NO_LOG_FILES
from kapitsa_ros.ros.context import refuse_second_context
from kapitsa_ros.ros.log_output import refuse_unknown_switches
from kapitsa_ros.ros.parameters import noting_declarations
from kapitsa_ros.ros.process_node import destroying_half_made
from kapitsa_ros.ros.reachability import PEERS, RANGE, refuse_unreachable
from kapitsa_ros.ros.type_support import load_generator

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from kapitsa_ros.ros.parameters import Declaration
    from kapitsa_ros.ros.process_node import ProcessNode

_OF_DISCOVERY = (RANGE, PEERS, 'ROS_DISCOVERY_SERVER', 'ROS_SECURITY_ENABLE')
"""Variables that say whom a node finds."""


def help_text(role: str, description: str, create: Callable[[], ProcessNode]) -> str:
    """Return the help of a node, which is made for it and destroyed: its constructor declares the parameters.

    Raises
    ------
    SettingError
        No node can be made here.

    """
    refuse_second_context()
    refuse_unknown_switches()
    refuse_unreachable()
    load_generator()
    with _unseen(), noting_declarations() as declared:
        rclpy.init(args=NO_LOG_FILES, domain_id=0, signal_handler_options=SignalHandlerOptions.NO)
        try:
            with destroying_half_made():
                create().destroy_node()
        except KapitsaError:
            pass  # as a player without bags: all is declared by then
        finally:
            rclpy.try_shutdown()
    usage = f'usage: {role} [--ros-args -p PARAMETER:=VALUE ... --params-file FILE ...]'
    return '\n'.join([usage, '', description.strip(), '', 'parameters:', *map(_line, declared)])


@contextmanager
def _unseen() -> Iterator[None]:
    """Let no other node see those that are made in the context: a rig would take one for a second writer."""
    before = {name: os.environ.pop(name) for name in _OF_DISCOVERY if name in os.environ}
    os.environ[RANGE] = 'OFF'
    try:
        yield
    finally:
        del os.environ[RANGE]
        os.environ.update(before)


def composed_help_text(roles: Iterable[str]) -> str:
    """Return the help of nodes that share a process."""
    return (
        f'usage: {COMPOSED} [ROLE ...] [--ros-args -p PARAMETER:=VALUE ... --params-file FILE ...]\n\n'
        f'Several nodes in one process; without a ROLE all those of a rig. Roles: {", ".join(roles)}.\n'
        'Parameters are those of the nodes, each of which takes its own: ROLE --help tells of them.'
    )


def _line(declared: Declaration) -> str:
    bounds = f', in [{declared.low:g}, {declared.high:g}]' if declared.low is not None else ''
    return f'  {declared.name}: {declared.description} (default {declared.default}{bounds})'
