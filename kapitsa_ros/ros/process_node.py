"""What a process of nodes asks of each: to be polled when that is due, and to tell why it fails."""

from __future__ import annotations

import functools
import weakref
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from rclpy._rclpy_pybind11 import RCLError  # it has no public type
from rclpy.node import Node

from kapitsa_ros.errors import shorten
from kapitsa_ros.ros.throttle import Throttle

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kapitsa_ros.network.role import Role


_made: weakref.WeakSet[ProcessNode] = weakref.WeakSet()
"""All of this process, finished or not."""
REFUSAL_PERIOD = 5.0
"""Seconds of wall time between two lines on input that was not used."""
LONGEST = 200
"""Characters of a line on input that is refused."""
ASKS_ITSELF = 'asks_itself'
"""Attribute of callbacks that ask for a poll where they need one."""


class ProcessNode(Node):
    """Base of what `ros/main.py` runs.

    Callbacks of services and subscriptions make the node due at once, but for those that have `ASKS_ITSELF`: numbered
    topics, which make up all but a few of its messages, and ask for little that is not done when they come. What
    rclpy's own callbacks cannot use, as parameters of no type, is refused; an error of ours ends the node.

    Parameters
    ----------
    role
        Its name is the node's.

    """

    def __init__(self, role: Role) -> None:
        super().__init__(role.name)
        _made.add(self)
        self.role = role
        self.finished = False
        self.due = 0.0
        """When it has to be polled, s of the steady clock."""
        self.wake: Callable[[], None] = _nobody
        """Ends the wait of whoever polls it."""
        self.refused = 0
        """Messages and calls that were not used."""
        self._refusals = Throttle(REFUSAL_PERIOD)

    def be_due(self, at: float = 0.0) -> None:
        """Have the node polled at a time of the steady clock, if not before."""
        if at < self.due:
            self.due = at
            self.wake()

    def create_subscription(self, msg_type: Any, topic: str, callback: Any, *given: Any, **named: Any) -> Any:
        """Subscribe; a message makes the node due."""
        called = callback if hasattr(callback, ASKS_ITSELF) else self._making_due(callback, f'a message on {topic}')
        return super().create_subscription(msg_type, topic, called, *given, **named)

    def create_service(self, srv_type: Any, srv_name: str, callback: Any, **named: Any) -> Any:
        """Serve; a request makes the node due."""
        return super().create_service(srv_type, srv_name, self._making_due(callback, f'a call of {srv_name}'), **named)

    def _making_due(self, callback: Callable[..., Any], what: str) -> Callable[..., Any]:
        @functools.wraps(callback)  # rclpy looks at its signature
        def call(*given: Any) -> Any:
            try:
                return callback(*given)
            except Exception as error:
                is_of_rclpy = str(getattr(callback, '__module__', '')).startswith('rclpy.')
                if not (is_of_rclpy and self.context.ok()):
                    raise
                self.refuse(f'{what}: {error or type(error).__name__}')
                return given[-1]  # of a service the answer, as it came
            finally:
                self.be_due()

        return call

    def refuse(self, why: str) -> None:
        """Count input that was not used, and say so once in a while."""
        self.refused += 1
        if self._refusals.due():
            self.get_logger().warning(f'refused: {shorten(why, LONGEST)} ({self.refused} so far)')

    def open(self) -> None:
        """Serve others than ROS: called once, when all nodes of the process are made, and not where help is asked for.

        Raises
        ------
        NodeError
            It cannot be done here, or not as the parameters want it.

        """

    def poll(self) -> float:
        """Do what is due; return the seconds until the next call."""
        raise NotImplementedError

    def close(self) -> None:
        """Leave nothing half done: called once, however the node ends."""

    def fail(self, error: Exception) -> None:
        """Tell whoever watches why this node ends; stderr has its own line."""
        with suppress(RCLError):  # nobody can be told once a signal has shut the context
            self.get_logger().fatal(str(error))


def _nobody() -> None:
    pass


@contextmanager
def destroying_half_made() -> Iterator[None]:
    """Destroy what a constructor has made of a node before it raised: DDS would leave its files behind."""
    known = set(_made)
    try:
        yield
    except BaseException:
        for node in set(_made) - known:
            node.destroy_node()
        raise
