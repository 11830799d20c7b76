"""`python -m kapitsa_ros.nodes ROLE [--ros-args ...]`: one node as a process; or several, as `composed ROLE ...`."""

from __future__ import annotations

import os
import sys
import threading
from importlib import import_module
from typing import TYPE_CHECKING, NoReturn

from kapitsa_ros.errors import FAILED, KapitsaError
from kapitsa_ros.process_title import show_as
from kapitsa_ros.standard_streams import keep_streams_open

if TYPE_CHECKING:
    from types import ModuleType

try:
    from kapitsa_ros.ros.signals import leave_on_signals, restoring_signals
except KapitsaError as refusal:  # of the middleware; no traceback where this is the program
    if __name__ != '__main__':
        raise
    print(f'kapitsa: error: {refusal}', file=sys.stderr)
    sys.exit(refusal.exit_status)


def main(arguments: list[str] | None = None) -> int:
    """Run the node named first, in a program that goes on afterwards; what follows are ROS arguments.

    Returns
    -------
    int
        The exit status of the node.

    """
    if threading.current_thread() is not threading.main_thread():
        print('kapitsa: error: a node takes the signals of its process: call main in the main thread', file=sys.stderr)
        return FAILED
    with restoring_signals():
        return run_node(sys.argv[1:] if arguments is None else arguments)


def run_node(arguments: list[str]) -> int:
    """Run what is named first, in a process that ends with it: a role, or `composed` and several; then ROS arguments.

    Returns
    -------
    int
        The exit status of the node.

    """
    # Not above: the imports take half a second, in which signals are heard already.
    from kapitsa_ros.docstrings import docstring_of  # noqa: PLC0415
    from kapitsa_ros.errors import WRONG_INPUT, MissingPackageError  # noqa: PLC0415
    from kapitsa_ros.network.registry import NODE_NAMES, ROLE_NAMES  # noqa: PLC0415
    from kapitsa_ros.ros.arguments import COMPOSED, FOXGLOVE_SERVER, beside_ros, without_roles  # noqa: PLC0415
    from kapitsa_ros.ros.help_text import composed_help_text, help_text  # noqa: PLC0415
    from kapitsa_ros.ros.main import run_composed  # noqa: PLC0415

    name = arguments[0] if arguments else None
    roles: tuple[str, ...] = (name,) if name else ()
    if name == COMPOSED:
        arguments, named = without_roles(arguments)
        roles = named or ROLE_NAMES
    unknown = [role for role in roles if role not in NODE_NAMES and roles != (FOXGLOVE_SERVER,)]
    if unknown or not roles:
        given = repr(unknown[0]) if unknown else 'none'
        choice = ', '.join((*NODE_NAMES, COMPOSED, FOXGLOVE_SERVER))
        print(f'kapitsa: error: node {given} is unknown: choose one of {choice}', file=sys.stderr)
        return WRONG_INPUT
    try:
        modules = {role: _module(role) for role in roles}
    except MissingPackageError as error:
        print(f'{name}: error: {error}', file=sys.stderr)
        return error.exit_status
    if {'-h', '--help'} & set(beside_ros(arguments)):
        try:
            text = (
                composed_help_text(NODE_NAMES)
                if name == COMPOSED
                else help_text(roles[0], docstring_of(modules[roles[0]]), modules[roles[0]].create)
            )
        except KapitsaError as error:
            print(f'{name}: error: {error}', file=sys.stderr)
            return error.exit_status
        print(text)
        return 0
    return run_composed(arguments, {role: module.create for role, module in modules.items()})


def _module(role: str) -> ModuleType:
    """Return what has the `create` of a node."""
    from kapitsa_ros.extras import import_of_extra  # noqa: PLC0415
    from kapitsa_ros.ros.arguments import FOXGLOVE_SERVER  # noqa: PLC0415

    if role != FOXGLOVE_SERVER:
        return import_module(f'kapitsa_ros.nodes.{role}')
    module: ModuleType = import_of_extra('kapitsa_ros.live_view.server_node', f'node {role}', 'foxglove')
    return module


def _exit(status: int) -> NoReturn:
    """End the process, signals still ignored: all is closed, and to take down an interpreter takes its time."""
    try:
        sys.stdout.flush()
    except OSError as error:  # of what --help says
        status = FAILED
        if not isinstance(error, BrokenPipeError):
            print(f'kapitsa: error: {error}', file=sys.stderr)
    sys.stderr.flush()
    os._exit(status)


if __name__ == '__main__':
    leave_on_signals()
    keep_streams_open()
    show_as('kapitsa_ros.nodes', *sys.argv[1:])
    # The matrices of a node are small: threads of a BLAS would only take the cores from the other nodes.
    os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
    # Fast DDS writes its complaints to stdout.
    sys.stdout = os.fdopen(os.dup(1), 'w')
    os.dup2(2, 1)
    _exit(run_node(sys.argv[1:]))
