"""`python -m kapitsa_ros.nodes NAME`: run one node until its session is over or a signal comes."""

from __future__ import annotations

import itertools
import os
import sys
from importlib import import_module
from pathlib import Path

import rclpy
from rclpy._rclpy_pybind11 import (  # a params file that cannot be parsed has no public type
    RCLError,
    UnknownROSArgsError,
)
from rclpy.executors import ExternalShutdownException
from rclpy.experimental import EventsExecutor

from kapitsa_ros.nodes.errors import NodeError, SettingError
from kapitsa_ros.recording.errors import BagError

ROLES = ('jigsaw', 'pendulum', 'strobe', 'stopwatch', 'operator', 'analyser', 'recorder', 'player')


def main(arguments: list[str] | None = None) -> int:
    """Run the node named first; what follows are ROS arguments. Return the exit status."""
    arguments = sys.argv[1:] if arguments is None else arguments
    if not arguments or arguments[0] not in ROLES:
        given = repr(arguments[0]) if arguments else 'none'
        print(f'kapitsa: error: node {given} is unknown: choose one of {", ".join(ROLES)}', file=sys.stderr)
        return 2
    role = arguments[0]
    try:
        return _spin(role, arguments)
    except SettingError as error:
        print(f'{role}: error: {error}', file=sys.stderr)
        return 2
    except (NodeError, BagError, ValueError, OSError) as error:
        print(f'{role}: error: {error}', file=sys.stderr)
        return 1
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    finally:
        rclpy.try_shutdown()


def _start(arguments: list[str]) -> None:
    """Hand the ROS arguments over; what rcl cannot parse is named in one line, and not in its own ten."""
    for option, value in itertools.pairwise(arguments):
        if option == '--params-file' and not Path(value).is_file():
            raise SettingError(f'--params-file {value}: there is no such file')
    try:
        rclpy.init(args=arguments)
    except (RCLError, UnknownROSArgsError) as error:
        raise SettingError(f'ROS arguments: {str(error).splitlines()[0]}') from error


def _spin(role: str, arguments: list[str]) -> int:
    _start(arguments)
    try:
        node = import_module(f'kapitsa_ros.nodes.{role}').create()
    except RCLError as error:
        domain = os.environ.get('ROS_DOMAIN_ID', 'unset')
        raise SettingError(f'no node can be made, ROS_DOMAIN_ID is {domain}: {str(error).splitlines()[0]}') from error
    executor = EventsExecutor()
    executor.add_node(node)
    try:
        # The executor's own spin() busy-loops in these wheels; spin_once with a time-out does not.
        while not node.finished and rclpy.ok() and _rig_is_there():
            executor.spin_once(timeout_sec=node.poll())
    finally:
        node.close()
        executor.shutdown()
        node.destroy_node()
    return 0


def _rig_is_there() -> bool:
    """Whether the process that started this one as part of a rig, if one did, still runs."""
    return os.environ.get('KAPITSA_RIG_PID', str(os.getppid())) == str(os.getppid())


if __name__ == '__main__':
    sys.exit(main())
