"""What `NODE --help` prints: the parameters that the node declares, with meaning, default and range."""

from __future__ import annotations

from typing import TYPE_CHECKING

import rclpy

from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.ros.arguments import COMPOSED, NO_LOG_FILES
from kapitsa_ros.ros.parameters import noting_declarations
from kapitsa_ros.ros.process_node import destroying_half_made
from kapitsa_ros.ros.reachability import refuse_unreachable
from kapitsa_ros.ros.type_support import load_generator

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kapitsa_ros.ros.parameters import Declaration
    from kapitsa_ros.ros.process_node import ProcessNode


def help_text(role: str, description: str, create: Callable[[], ProcessNode]) -> str:
    """Return the help of a node, which is made for it and destroyed: its constructor declares the parameters.

    Raises
    ------
    SettingError
        No node can be made here.

    """
    refuse_unreachable()
    load_generator()
    rclpy.init(args=NO_LOG_FILES)
    with noting_declarations() as declared:
        try:
            with destroying_half_made():
                create().destroy_node()
        except KapitsaError:
            pass  # as a player without bags: all is declared by then
        finally:
            rclpy.try_shutdown()
    usage = f'usage: {role} [--ros-args -p PARAMETER:=VALUE ... --params-file FILE ...]'
    return '\n'.join([usage, '', description.strip(), '', 'parameters:', *map(_line, declared)])


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
