"""A node beside a rig: it listens, speaks and calls as anybody's may."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from kapitsa_ros.rig.environment import on_loopback

PATIENCE = 120.0


@contextmanager
def stranger_node(name: str, domain: int, *, serves_parameters: bool = True) -> Iterator[Node]:
    context = Context()
    with on_loopback():
        context.init(domain_id=domain)
        node = Node(name, context=context, start_parameter_services=serves_parameters)
    try:
        yield node
    finally:
        node.destroy_node()
        context.try_shutdown()


def call_service(node: Node, kind: Any, service: str, **request: Any) -> Any:
    """Return what is answered; None: nothing in time."""
    client = node.create_client(kind, service)
    assert client.wait_for_service(PATIENCE)
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    future = client.call_async(kind.Request(**request))
    executor.spin_until_future_complete(future, PATIENCE)
    executor.shutdown()
    return future.result()
