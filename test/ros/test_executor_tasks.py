"""What a task of the executor raises ends no process."""

from collections.abc import Callable
from typing import Any

from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.task import Future

from kapitsa_ros.network.registry import STROBE_READING
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.ros.executor_tasks import guarded
from kapitsa_ros.ros.numbered_subscription import NumberedSubscription
from kapitsa_ros.ros.qos import STREAM, message_class


def test_what_a_handler_of_events_raises_is_handed_on(
    domain: int, eventually: Callable[[Callable[[], Any]], None]
) -> None:
    """The executor dies of it where it has one node: a listener that was being left took its program with it."""
    context, raised = Context(), []
    with on_loopback():
        context.init(domain_id=domain)
        node = Node('reader', context=context)

    def met() -> None:
        raise RuntimeError('a writer has come')

    def ignore(*_: Any) -> None:
        pass

    executor = EventsExecutor(context=context)
    NumberedSubscription(node, STROBE_READING, ignore, ignore, raised.append, met=met)
    executor.add_node(node)
    node.create_publisher(message_class(STROBE_READING.type), STROBE_READING.name, STREAM)
    try:
        eventually(lambda: executor.spin_until_future_complete(Future(), timeout_sec=0.05) or raised)
    finally:
        executor.remove_node(node)
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()
    assert [str(error) for error in raised] == ['a writer has come']


def test_a_guarded_callback_returns_what_it_returns() -> None:
    assert guarded(lambda given: given + 1, print)(2) == 3
