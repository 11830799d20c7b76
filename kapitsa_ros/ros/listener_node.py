"""Base of the nodes that listen from a program's own process, in a thread of their own."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Self

import rclpy
from rclpy._rclpy_pybind11 import RCLError  # it has no public type
from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.task import Future

from kapitsa_ros.ros.arguments import NO_LOG_FILES
from kapitsa_ros.ros.errors import NodeError
from kapitsa_ros.ros.log_output import refuse_unknown_switches
from kapitsa_ros.ros.network_interfaces import wait_for_network_interfaces
from kapitsa_ros.ros.rclpy_errors import is_of_rclpy, no_node_text
from kapitsa_ros.ros.reachability import refuse_unreachable
from kapitsa_ros.ros.shutdown import wait_until_quiet
from kapitsa_ros.ros.type_support import load_generator

if TYPE_CHECKING:
    from types import TracebackType

_LOOK_PERIOD = 1.0
"""Seconds between two looks at whether ROS is up; its shutdown ends the wait."""
PATIENCE = 1.0
"""Seconds for which the domain may take to come to rest before a listener leaves it."""


class ListenerNode:
    """A node with a context of its own, so that several rigs fit in one process. A context: it listens while it lasts.

    Parameters
    ----------
    name
        Of the node; roles wait for it if their parameter `expect` names it.
    domain
        ROS domain of the rig.

    Raises
    ------
    NodeError
        No node can be made here; the message says why.

    """

    def __init__(self, name: str, domain: int) -> None:
        refuse_unknown_switches()
        refuse_unreachable()
        wait_for_network_interfaces()
        self._domain = domain
        self._failure: BaseException | None = None
        self._dispute: NodeError | None = None
        """Of what was heard, that two have said it, and nobody can tell which is right."""
        self._context = Context()
        load_generator()
        try:
            # The arguments of the program are its own, and so is a home that takes log files.
            rclpy.init(args=NO_LOG_FILES, context=self._context, domain_id=domain)
            self._node = Node(name, context=self._context, start_parameter_services=False, enable_rosout=False)
            self._executor = EventsExecutor(context=self._context)
        except RuntimeError as error:
            # What C++ throws, as without file descriptors, is a plain one; so is Python's of a domain that is none.
            if not (isinstance(error, RCLError) or self._context.ok()):
                raise
            self._context.try_shutdown()
            raise NodeError(no_node_text(error)) from error
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._spin, daemon=True)

    def __enter__(self) -> Self:
        """Begin to listen."""
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop listening; raise what a callback has raised, unless something else is being raised."""
        self._context.try_shutdown()
        self._thread.join()
        self._executor.shutdown()
        # Others may just be leaving.
        wait_until_quiet(self._domain, PATIENCE)
        self._node.destroy_node()
        if error is None:
            self.check()

    def check(self) -> None:
        """Raise what a callback has raised: after that nothing more is heard."""
        if self._failure is not None:
            raise self._failure

    def fail(self, error: Exception) -> None:
        """Keep what a callback has raised for whoever waits; what is disputed the nodes of the rig say, if they can."""
        if is_of_rclpy(error) and not self._context.ok():  # it was being left meanwhile
            return
        if isinstance(error, NodeError):
            self._dispute = self._dispute or error
        else:
            self._failure = error
        self.wake()

    def refuse_disputed(self) -> None:
        """Raise what is disputed, once the nodes of the rig have left and can no longer say it."""
        if self._dispute is not None:
            raise NodeError(f'{self._dispute}; choose another ROS_DOMAIN_ID, or stop it') from self._dispute

    def wake(self) -> None:
        """Make whoever waits for news look again; called from the listening thread."""

    def _spin(self) -> None:
        try:
            never = Future()
            while self._context.ok():
                # One call for all messages that come meanwhile: to come back with each is a part of what it costs.
                self._executor.spin_until_future_complete(never, timeout_sec=_LOOK_PERIOD)
        except BaseException as error:  # noqa: BLE001  # it is raised where somebody waits; SystemExit, too
            if self._context.ok() or not (isinstance(error, Exception) and is_of_rclpy(error)):
                self._failure = error
                self.wake()
