"""A client of the graph: what strangers send is left out, and one that cannot be made leaves no descriptor open."""

import select
from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from rclpy.context import Context
from rclpy.node import Node
from stranger_node import stranger_node

from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.network.cdr import encode_header
from kapitsa_ros.network.registry import STROBE_READING
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.rig import Rig
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.ros.errors import NodeError
from kapitsa_ros.ros.node_names import node_names
from kapitsa_ros.ros.qos import STREAM, message_class
from kapitsa_ros.ros.rig_client import RigClient

pytestmark = pytest.mark.xdist_group('processes')


def eventfds() -> int:
    return sum('eventfd' in str(path.readlink()) for path in Path('/proc/self/fd').iterdir() if path.is_symlink())


def test_a_client_that_cannot_be_made_leaves_no_descriptor() -> None:
    before = eventfds()
    with pytest.raises(RuntimeError, match='Domain id'):
        RigClient(-5)
    assert eventfds() == before


def test_what_two_have_said_is_told_on_leaving_a_rig(eventually: Callable[[Callable[[], Any]], None]) -> None:
    """No node of the rig has heard it."""

    topic, context = STROBE_READING.name, Context()
    nodes: list[Node] = []

    def writer_of(name: str) -> Any:
        nodes.append(Node(name, context=context))
        publisher = nodes[-1].create_publisher(message_class(STROBE_READING.type), topic, STREAM)
        eventually(publisher.get_subscription_count)
        return publisher

    def say(writer: Any, step: int, speed: float) -> None:
        writer.publish(STROBE_READING.encode(1, StepId(1, step), StrobeReading(time=0.1, speed=speed)))
        assert writer.wait_for_all_acked()

    def use(rig: Rig) -> None:
        with on_loopback():
            context.init(domain_id=rig.domain)
        strobe = writer_of('strobe')
        say(strobe, 0, 200.0)
        rig.wait_for(topic)
        stranger = writer_of('stranger')
        watching = rig._client._node
        eventually(lambda: 'stranger' in node_names(watching.get_publishers_info_by_topic(topic)))  # it comes last
        say(stranger, 0, 300.0)
        say(strobe, 1, 250.0)
        rig.wait_for(topic, lambda reading: reading.speed == pytest.approx(250.0))

    said = r'^strobe/reading has a second writer, stranger: .*ROS_DOMAIN_ID'
    with pytest.raises(NodeError, match=said), Rig(nodes=['jigsaw']) as rig:
        use(rig)
    context.try_shutdown()


def test_what_came_before_it_was_found_is_told(eventually: Callable[[Callable[[], Any]], None]) -> None:
    """A reading that a program waits for may be among that."""
    topic, steps = STROBE_READING.name, count(5)
    with Rig(nodes=['jigsaw']) as rig, stranger_node('strobe', rig.domain) as strobe:
        publisher = strobe.create_publisher(message_class(STROBE_READING.type), topic, STREAM)

        def say_next() -> None:
            reading = StrobeReading(time=1.0, speed=200.0)
            publisher.publish(STROBE_READING.encode(1, StepId(2, next(steps)), reading))

        eventually(lambda: say_next() or rig.latest(topic))
        told = r'heard strobe/reading only from run 2 step \d+ on: name client, too, in the parameter expect'
        with pytest.raises(TimeoutError, match=told):
            rig.wait_for(topic, lambda _: False, timeout=0.1)


def test_messages_of_strangers_are_left_out(domain: int, eventually: Callable[[Callable[[], Any]], None]) -> None:
    """D16. Their number can be read, and nothing else."""
    context = Context()
    with on_loopback():
        context.init(domain_id=domain)
        stranger = Node('strobe', context=context)  # as it calls itself
        client = RigClient(domain)
    topic = STROBE_READING.name
    with client:
        try:
            publisher = stranger.create_publisher(message_class(STROBE_READING.type), topic, STREAM)
            eventually(publisher.get_subscription_count)
            publisher.publish(encode_header(0, StepId(1, 0)) + b'\xff' * 64)
            publisher.publish(STROBE_READING.encode(1, StepId(1, 1), StrobeReading(time=0.1, speed=200.0)))
            publisher.publish(encode_header(2, StepId(1, 2)) + b'\xff' * 64)
            while client.seen[topic] != StepId(1, 2):
                assert select.select([client.news], [], [], 60.0)[0]
                client.clear_news()
            assert client.latest(topic) is None
            assert client.take(topic, None).speed == pytest.approx(200.0)
            assert client.take(topic, None) is None
            publisher.publish(encode_header(3, StepId(1, 3)) + b'\xff' * 64)
            while client.seen[topic] != StepId(1, 3):
                assert select.select([client.news], [], [], 60.0)[0]
                client.clear_news()
            assert client.take_all() == []
        finally:
            stranger.destroy_node()
            context.try_shutdown()
