"""What a task of the executor raises ends no process."""

from collections.abc import Callable
from typing import Any

from rclpy.experimental import EventsExecutor
from rclpy.task import Future
from stranger_node import stranger_node

from kapitsa_ros.network.registry import STROBE_READING
from kapitsa_ros.ros.executor_tasks import guarded
from kapitsa_ros.ros.numbered_subscription import NumberedSubscription
from kapitsa_ros.ros.qos import STREAM, message_class


def test_what_a_handler_of_events_raises_is_handed_on(
    domain: int, eventually: Callable[[Callable[[], Any]], None]
) -> None:
    """The executor dies of it where it has one node: a listener that was being left took its program with it."""
    raised: list[Exception] = []

    def met() -> None:
        raise RuntimeError('a writer has come')

    def ignore(*_: Any) -> None:
        pass

    with stranger_node('reader', domain) as node:
        executor = EventsExecutor(context=node.context)
        NumberedSubscription(node, STROBE_READING, ignore, ignore, raised.append, met=met)
        executor.add_node(node)
        node.create_publisher(message_class(STROBE_READING.type), STROBE_READING.name, STREAM)
        eventually(lambda: executor.spin_until_future_complete(Future(), timeout_sec=0.05) or raised)
        executor.remove_node(node)
        executor.shutdown()
    assert [str(error) for error in raised] == ['a writer has come']


def test_a_guarded_callback_returns_what_it_returns() -> None:
    assert guarded(lambda given: given + 1, print)(2) == 3
