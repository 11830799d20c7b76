"""The parameters of the rig's nodes, for clients of the view, as `/NODE.PARAMETER`."""

from __future__ import annotations

import threading
from functools import partial
from typing import TYPE_CHECKING, Any

import foxglove
from foxglove.websocket import ParameterType
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterEvent
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_parameter_events

from kapitsa_ros.live_view.answer import answer_to
from kapitsa_ros.live_view.names import is_full_name
from kapitsa_ros.network.registry import NODE_NAMES
from kapitsa_ros.ros.executor_tasks import guarded

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from rclpy.node import Node

    from kapitsa_ros.live_view.foxglove_server import FoxgloveServer
    from kapitsa_ros.ros.process_node import ProcessNode

_PATIENCE = 2.0
"""Seconds."""
_HINTS = {Parameter.Type.DOUBLE: ParameterType.Float64, Parameter.Type.DOUBLE_ARRAY: ParameterType.Float64Array}


class ParameterForwarder:
    """Keeps what the parameters are, and sets them.

    Parameters
    ----------
    node
        Who asks the nodes.
    server
        Whose clients see the parameters.

    """

    def __init__(self, node: ProcessNode, server: FoxgloveServer) -> None:
        self._node, self._server = node, server
        self._nodes: dict[str, _NodeParameters] = {}
        self._news = threading.Condition()
        """Held for the values, which threads of the server read."""
        node.create_subscription(ParameterEvent, '/parameter_events', self._take_event, qos_profile_parameter_events)

    def look(self) -> None:
        """Ask nodes that have come, and forget those that have gone."""
        full_names = (
            f'{"" if space == "/" else space}/{name}'
            for name, space in self._node.get_node_names_and_namespaces()
            if name in NODE_NAMES
        )
        there = set(filter(is_full_name, full_names))
        with self._news:
            for name in self._nodes.keys() - there:
                self._nodes.pop(name).close()
            for name in there - self._nodes.keys():
                refuse = partial(self._refuse, name)
                self._nodes[name] = _NodeParameters(self._node, name, partial(self.take, name), refuse)
        for parameters in self._nodes.values():
            parameters.ask()

    def value(self, name: str, default: Any) -> Any:
        """Return the value of a parameter such as `/player.rate`, or something else where it is unknown."""
        node, _, parameter = name.rpartition('.')
        known = self._nodes.get(node)
        return default if known is None or parameter not in known.values else known.values[parameter].value

    def get(self, names: list[str]) -> list[foxglove.Parameter]:
        """Return parameters by their names, or all; a client that has come early has to wait for what the nodes say."""
        with self._news:
            self._news.wait_for(lambda: self._have_answered(names), _PATIENCE)
            known = {
                f'{node}.{name}': value
                for node, parameters in self._nodes.items()
                for name, value in parameters.values.items()
            }
        return [_shown(name, known[name]) for name in sorted(known) if not names or name in names]

    def _have_answered(self, names: list[str]) -> bool:
        if names:
            return all(self.value(name, None) is not None for name in names)
        return bool(self._nodes) and all(parameters.values for parameters in self._nodes.values())

    def set(self, given: list[foxglove.Parameter]) -> list[foxglove.Parameter]:
        """Set parameters as far as their nodes allow it, and return what they are then; a refusal is shown."""
        for parameter in given:
            why = self._set(parameter)
            if why is not None:
                self._server.warn(f'{parameter.name}: {why}')
        return self.get([parameter.name for parameter in given])

    def _set(self, given: foxglove.Parameter) -> str | None:
        """Set a parameter; return why it cannot be."""
        node, _, name = given.name.rpartition('.')
        known = self._nodes.get(node)
        if known is None or name not in known.values:
            return 'there is no such parameter'
        kind = known.values[name].type_
        value = given.get_value()
        if kind is Parameter.Type.DOUBLE and type(value) is int:  # in JSON 2 and 2.0 are the same
            value = float(value)
        try:
            wanted = Parameter(name, kind, value)
            (result,) = answer_to(known.set(wanted), node).results
        except (ValueError, TypeError):
            return f'{value!r} is no {kind.name.lower()}'
        except TimeoutError as error:
            return str(error)
        if not result.successful:
            return str(result.reason)
        self.take(node, [wanted])
        return None

    def take(self, node: str, parameters: Iterable[Parameter]) -> None:
        """Note what parameters of a node are now, and show those that have changed."""
        known = self._nodes.get(node)
        if known is None:
            return
        changed = [item for item in parameters if known.values.get(item.name) != item]
        with self._news:
            known.values.update({item.name: item for item in changed})
            self._news.notify_all()
        if changed:
            self._server.show_parameters([_shown(f'{node}.{item.name}', item) for item in changed])

    def _take_event(self, event: ParameterEvent) -> None:
        self.take(event.node, _read([*event.new_parameters, *event.changed_parameters]))

    def _refuse(self, node: str, error: Exception) -> None:
        self._node.refuse(f'parameters of {node}: {error}')


class _NodeParameters:
    def __init__(self, node: Node, name: str, take: Any, refuse: Callable[[Exception], None]) -> None:
        self.values: dict[str, Parameter] = {}
        self._node, self._take, self._refuse = node, take, refuse
        self._list = node.create_client(ListParameters, f'{name}/list_parameters')
        self._get = node.create_client(GetParameters, f'{name}/get_parameters')
        self._set = node.create_client(SetParameters, f'{name}/set_parameters')
        self._is_asked = False

    def close(self) -> None:
        for client in (self._list, self._get, self._set):
            self._node.destroy_client(client)

    def ask(self) -> None:
        """Ask the node for all its parameters, once it can answer."""
        if not self._is_asked and self._list.service_is_ready() and self._get.service_is_ready():
            self._is_asked = True
            asking = self._list.call_async(ListParameters.Request())
            asking.add_done_callback(guarded(self._take_names, self._refuse))

    def set(self, parameter: Parameter) -> Any:
        return self._set.call_async(SetParameters.Request(parameters=[parameter.to_parameter_msg()]))

    def _take_names(self, future: Any) -> None:
        names = future.result().result.names
        asking = self._get.call_async(GetParameters.Request(names=names))
        take = guarded(lambda answered: self._take_values(names, answered.result().values), self._refuse)
        asking.add_done_callback(take)

    def _take_values(self, names: list[str], values: Any) -> None:
        if len(values) != len(names):
            raise ValueError(f'{len(values)} values of {len(names)} parameters')
        self._take(_read([ParameterMessage(name=name, value=value) for name, value in zip(names, values, strict=True)]))


def _read(messages: list[ParameterMessage]) -> list[Parameter]:
    """Return parameters; ValueError: one is none."""
    return list(map(Parameter.from_parameter_msg, messages))


def _shown(name: str, parameter: Parameter) -> foxglove.Parameter:
    value = parameter.value
    if parameter.type_ is Parameter.Type.BYTE_ARRAY:
        value = b''.join(value)
    elif value is not None and not isinstance(value, bool | int | float | str):
        value = list(value)
    return foxglove.Parameter(name, value=value, type=_HINTS.get(parameter.type_))
