"""A client of the services and parameters of simulated time (see `TimeControl`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.task import Future

SERVICES = ('pause', 'resume', 'toggle_paused', 'step')
"""Of every node that owns time."""
RESET = 'reset'
"""Of the jigsaw besides."""


class TimeControlClient:
    """Calls the node that owns time; nothing here waits.

    Parameters
    ----------
    node
        Who calls.
    owner
        Name of the node that owns time.
    further
        Services that this owner has besides.

    """

    def __init__(self, node: Node, owner: str, *further: str) -> None:
        self._services = {name: node.create_client(Trigger, f'{owner}/{name}') for name in (*SERVICES, *further)}
        self._parameters = node.create_client(SetParameters, f'{owner}/set_parameters')

    def is_served(self) -> bool:
        """Whether the owner is there for calls."""
        return all(client.service_is_ready() for client in (*self._services.values(), self._parameters))

    def call(self, service: str) -> Future:
        """Call a service; the answer is a Trigger.Response."""
        return self._services[service].call_async(Trigger.Request())

    def set_parameters(self, **values: float) -> Future:
        """Set parameters; the answer is a SetParameters.Response."""
        wanted = [Parameter(name, value=value).to_parameter_msg() for name, value in values.items()]
        return self._parameters.call_async(SetParameters.Request(parameters=wanted))
