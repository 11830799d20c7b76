"""What a process of nodes asks of each: to be polled when that is due, and to tell why it fails."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from rclpy._rclpy_pybind11 import RCLError  # it has no public type
from rclpy.node import Node

if TYPE_CHECKING:
    from kapitsa_ros.network.role import Role


class ProcessNode(Node):
    """Base of what `ros/main.py` runs.

    Parameters
    ----------
    role
        Its name is the node's.

    """

    def __init__(self, role: Role) -> None:
        super().__init__(role.name)
        self.role = role
        self.finished = False
        self.heard = False
        """Whether a message has come since somebody has looked, and..."""
        self.wait = 0.0
        """... in how many seconds the node has to be polled, as it has left it."""

    def poll(self) -> float:
        """Do what is due; return the seconds until the next call."""
        raise NotImplementedError

    def close(self) -> None:
        """Leave nothing half done: called once, however the node ends."""

    def fail(self, error: Exception) -> None:
        """Tell whoever watches why this node ends; stderr has its own line."""
        with suppress(RCLError):  # nobody can be told once a signal has shut the context
            self.get_logger().fatal(str(error))
