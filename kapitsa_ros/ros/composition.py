"""The nodes of a process, of one or of several: made, spun in one thread, and taken down together."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.exceptions import InvalidParameterTypeException
from rclpy.experimental import EventsExecutor
from rclpy.task import Future

from kapitsa_ros.network.registry import NODE_NAMES
from kapitsa_ros.ros.errors import SettingError
from kapitsa_ros.ros.node_loop import NodeLoop
from kapitsa_ros.ros.parameters import unknown_parameters
from kapitsa_ros.ros.process_node import destroying_half_made
from kapitsa_ros.ros.rclpy_errors import is_of_rclpy, no_node_text
from kapitsa_ros.ros.shutdown import ShutdownWatchdog

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kapitsa_ros.ros.process_node import ProcessNode

PATIENCE = 1.0
"""Seconds given to DDS to take the nodes down."""


class Composition:
    """The nodes of a process.

    Parameters
    ----------
    creates
        What makes each node, once ROS is initialised, by its role.
    typed
        Names of parameters that were typed for this process, where those of a rig come in files.

    """

    def __init__(self, creates: Mapping[str, Callable[[], ProcessNode]], typed: frozenset[str] = frozenset()) -> None:
        self._creates = creates
        self._typed = typed if len(creates) == 1 else frozenset()
        self._nodes: list[ProcessNode] = []
        self._loop: NodeLoop | None = None
        self._executor: Any = None
        self._in_making = next(iter(creates))
        self._is_due = Future()
        """Settled when a node is due before it was to be."""

    @property
    def is_at_work(self) -> bool:
        """Whether all nodes are made."""
        return self._loop is not None

    @property
    def role(self) -> str:
        """Whose node is being made, or was last at work."""
        return self._in_making if self._loop is None else self._loop.at_work.role.name

    def make(self) -> None:
        """Make the nodes, while no signal shuts ROS down.

        Raises
        ------
        SettingError
            One cannot be made: `role` is whose.

        """
        for role, create in self._creates.items():
            self._in_making = role
            self._nodes.append(_create(create, self._typed))
            self._nodes[-1].wake = self._wake
        for node in self._nodes:
            self._in_making = node.role.name
            node.open()
        self._loop = NodeLoop(self._nodes)
        self._executor = EventsExecutor()
        for node in self._nodes:
            self._executor.add_node(node)
        # It registers what the nodes have when it spins first: where a signal shuts the context in the middle of that,
        # some of it stays registered, and its destructor aborts.
        self._executor.spin_once(timeout_sec=0.0)

    def spin(self, parent: int | None) -> None:
        """Let the nodes work until all have finished, ROS is shut down or the parent process is gone; then close them.

        Raises
        ------
        Exception
            What a node could not go on with: `role` is whose.

        """
        assert self._loop is not None  # noqa: S101  # they are made
        try:
            while not self._loop.is_over and rclpy.ok() and parent in (None, os.getppid()):
                # One call for all messages until a node is due: to come back with each would cost a tenth of the time.
                self._is_due = Future()
                self._executor.spin_until_future_complete(self._is_due, timeout_sec=self._loop.poll())
        finally:
            self._loop.close()

    def _wake(self) -> None:
        if not self._is_due.done():
            self._is_due.set_result(None)

    def fail(self, error: Exception) -> None:
        """Let the node that was at work tell why all end."""
        if self._loop is not None:
            self._loop.at_work.fail(error)

    def take_down(self, status: int) -> None:
        """Destroy the nodes and shut ROS down; where that hangs, the process ends with this status."""
        watchdog = ShutdownWatchdog(PATIENCE, status) if self._nodes else None
        if self._executor is not None:
            for node in self._nodes:
                self._executor.remove_node(node)
            self._executor.shutdown()
            self._executor = None  # in the destructor of one that outlives its context C++ aborts
        for node in self._nodes:
            node.destroy_node()
        rclpy.try_shutdown()
        if watchdog is not None:
            watchdog.disarm()


def _refuse_other_name(node: ProcessNode) -> None:
    role, name = node.role.name, node.get_name()
    if role in NODE_NAMES and name != role:
        raise SettingError(
            f'the node is named {name}: its name has to be {role}, by which others look for it; '
            'a namespace tells rigs apart'
        )


def _create(create: Callable[[], ProcessNode], typed: frozenset[str]) -> ProcessNode:
    try:
        with destroying_half_made():
            node = create()
            _refuse_other_name(node)
    except RuntimeError as error:  # RCLError is one; what C++ throws, as without file descriptors, is plain
        if not (rclpy.ok() and is_of_rclpy(error)):
            raise
        raise SettingError(no_node_text(error)) from error
    except InvalidParameterTypeException as error:  # of what rclpy declares itself, as use_sim_time
        raise SettingError(f'parameter: {error}') from error
    for line in unknown_parameters(node, typed):
        node.get_logger().warning(line)
    node.get_logger().info(f'joins domain {node.context.get_domain_id()}')
    return node
