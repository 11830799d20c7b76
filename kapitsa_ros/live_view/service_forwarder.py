"""The services of those that own time, for clients of the view: pause, resume, step, and the jigsaw's reset."""

from __future__ import annotations

from typing import TYPE_CHECKING

from foxglove import MessageSchema, Schema, Service, ServiceSchema
from rclpy.serialization import serialize_message
from std_srvs.srv import Trigger

from kapitsa_ros.live_view.answer import answer_to
from kapitsa_ros.live_view.foxglove_server import ENCODING, SCHEMA_ENCODING
from kapitsa_ros.live_view.names import is_full_name
from kapitsa_ros.network.registry import JIGSAW, PLAYER
from kapitsa_ros.ros.time_control_client import RESET, SERVICES

if TYPE_CHECKING:
    from foxglove import ServiceRequest
    from rclpy.client import Client
    from rclpy.node import Node

    from kapitsa_ros.live_view.foxglove_server import FoxgloveServer

_TYPE = 'std_srvs/srv/Trigger'
_OFFERED = {(JIGSAW.name, name) for name in (*SERVICES, RESET)} | {(PLAYER.name, name) for name in SERVICES}
"""By the last two parts of their names: rigs may live in namespaces."""


def _message(part: str, definition: str) -> MessageSchema:
    return MessageSchema(
        encoding=ENCODING,
        schema=Schema(name=f'{_TYPE}_{part}', encoding=SCHEMA_ENCODING, data=definition.encode()),
    )


_SCHEMA = ServiceSchema(
    _TYPE, request=_message('Request', ''), response=_message('Response', 'bool success\nstring message')
)


class ServiceForwarder:
    """Offers each of these services that is there.

    Parameters
    ----------
    node
        Who calls.
    server
        Where they are offered.

    """

    def __init__(self, node: Node, server: FoxgloveServer) -> None:
        self._node, self._server = node, server
        self._clients: dict[str, Client] = {}

    def look(self) -> None:
        """Offer what has come, and no more what has gone."""
        there = {
            name
            for name, types in self._node.get_service_names_and_types()
            if types == [_TYPE] and is_full_name(name) and tuple(name.rsplit('/', 2)[1:]) in _OFFERED
        }
        if gone := sorted(self._clients.keys() - there):
            self._server.withdraw(gone)
            for name in gone:
                self._node.destroy_client(self._clients.pop(name))
        if come := sorted(there - self._clients.keys()):
            self._clients |= {name: self._node.create_client(Trigger, name) for name in come}
            self._server.offer([Service(name, schema=_SCHEMA, handler=self._call) for name in come])

    def _call(self, request: ServiceRequest) -> bytes:
        client = self._clients.get(request.service_name)
        if client is None:
            raise LookupError(f'{request.service_name} has gone')
        return bytes(serialize_message(answer_to(client.call_async(Trigger.Request()), request.service_name)))
