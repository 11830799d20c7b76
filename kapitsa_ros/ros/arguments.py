"""The arguments of a process of nodes: ROLE [--parent-pid PID] [--ros-args ...], or composed [...] ROLE ... [...]."""

from __future__ import annotations

from itertools import pairwise, takewhile

COMPOSED = 'composed'
"""In the place of a role: several nodes in one process; their roles follow, or else it is all those of a rig."""
FOXGLOVE_SERVER = 'foxglove_server'
"""In the place of a role: what shows a rig or a replay to clients of Foxglove's protocol."""
FOXGLOVE_PORT = 8765
"""Where they look first."""
PARENT_OPTION = '--parent-pid'
"""A node whose parent is no longer this process ends: nothing outlives its rig."""
NO_LOG_FILES = ['--ros-args', '--disable-external-lib-logs']
"""What is said goes to stderr and to `rosout` alone; files need a home that can be written."""


def split_parent(arguments: list[str]) -> tuple[list[str], int | None]:
    """Return the arguments without the parent's process id, and that; only what starts a node itself can give it."""
    if arguments[1:2] == [PARENT_OPTION] and len(arguments) > 2 and arguments[2].isdecimal():
        return [arguments[0], *arguments[3:]], int(arguments[2])
    return arguments, None


def without_roles(arguments: list[str]) -> tuple[list[str], tuple[str, ...]]:
    """Return the arguments of composed nodes without their roles, and those."""
    first = 3 if arguments[1:2] == [PARENT_OPTION] else 1
    roles = tuple(takewhile(lambda argument: not argument.startswith('-'), arguments[first:]))
    return arguments[:first] + arguments[first + len(roles) :], roles


def beside_ros(arguments: list[str]) -> list[str]:
    """Return what follows the role and is none of the ROS arguments, which end with `--`."""
    beside, is_of_ros = [], False
    for argument in arguments[1:]:
        if argument == '--ros-args':
            is_of_ros = True
        elif argument == '--' and is_of_ros:
            is_of_ros = False
        elif not is_of_ros:
            beside.append(argument)
    return beside


def typed_parameters(arguments: list[str]) -> frozenset[str]:
    """Return the names of the parameters that stand in the arguments themselves, and in no file."""
    typed = (value for option, value in pairwise(arguments) if option in {'-p', '--param'})
    return frozenset(value.partition(':=')[0].rpartition(':')[2] for value in typed)
