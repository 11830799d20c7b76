"""What others would do: one JointState a sample, from one node to as many others as a rig has.

Both return the CPU time of a sample, all nodes together. In one process each sample is waited for; as processes they
are written at 1 kHz, as by a simulation in real time.
"""

from __future__ import annotations

import multiprocessing
import time
from typing import TYPE_CHECKING

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState

from kapitsa_ros.network.registry import ROLE_NAMES
from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.ros.arguments import NO_LOG_FILES
from kapitsa_ros.ros.qos import STREAM

if TYPE_CHECKING:
    from multiprocessing.queues import Queue

    from rclpy.publisher import Publisher

SAMPLES = 5000
PERIOD = 1e-3
"""s."""
READERS = len(ROLE_NAMES) - 1
PATIENCE = 180.0
"""s, for a node that ends."""


def composed() -> float:
    """Have all nodes in this process."""
    with on_loopback(), reserved_domain() as domain:
        rclpy.init(args=NO_LOG_FILES, domain_id=domain)
        writer = Node('writer')
        readers = [Node(f'reader_{number}') for number in range(READERS)]
        publisher = writer.create_publisher(JointState, 'joint_states', STREAM)
        heard: list[float] = []
        executor = EventsExecutor()
        for reader in readers:
            reader.create_subscription(JointState, 'joint_states', lambda m: heard.append(m.position[0]), STREAM)
            executor.add_node(reader)
        while publisher.get_subscription_count() < READERS:
            executor.spin_once(timeout_sec=0.01)
        begin = time.process_time()
        for sample in range(SAMPLES):
            publish(writer, publisher, sample)
            while len(heard) < (sample + 1) * READERS:
                executor.spin_once(timeout_sec=1.0)
        used = time.process_time() - begin
        for reader in readers:
            executor.remove_node(reader)
        executor.shutdown()
        del executor
        for node in (writer, *readers):
            node.destroy_node()
        rclpy.shutdown()
    return used / SAMPLES


def as_processes() -> float:
    """Have each node in a process of its own."""
    spawning = multiprocessing.get_context('spawn')
    used: Queue[float] = spawning.Queue()
    with on_loopback(), reserved_domain() as domain:
        nodes = [spawning.Process(target=read, args=(domain, number, used)) for number in range(READERS)]
        nodes.append(spawning.Process(target=write, args=(domain, used)))
        for node in nodes:
            node.start()
        total = sum(used.get(timeout=PATIENCE) for _ in nodes)
        for node in nodes:
            node.join()
    return total / SAMPLES


def read(domain: int, number: int, used: Queue[float]) -> None:
    """Be a reader; put the CPU time from the first sample to the last."""
    rclpy.init(args=NO_LOG_FILES, domain_id=domain)
    node = Node(f'reader_{number}')
    heard: list[float] = []
    begin = 0.0

    def take(message: JointState) -> None:
        nonlocal begin
        begin = begin or time.process_time()
        heard.append(message.position[0])

    node.create_subscription(JointState, 'joint_states', take, STREAM)
    executor = EventsExecutor()
    executor.add_node(node)
    while len(heard) < SAMPLES:
        executor.spin_once(timeout_sec=1.0)
    used.put(time.process_time() - begin)


def write(domain: int, used: Queue[float]) -> None:
    """Be the writer; put the CPU time from the first sample to the last."""
    rclpy.init(args=NO_LOG_FILES, domain_id=domain)
    node = Node('writer')
    publisher = node.create_publisher(JointState, 'joint_states', STREAM)
    while publisher.get_subscription_count() < READERS:
        time.sleep(0.01)
    begin, start = time.process_time(), time.monotonic()
    for sample in range(SAMPLES):
        time.sleep(max(0.0, start + sample * PERIOD - time.monotonic()))
        publish(node, publisher, sample)
    used.put(time.process_time() - begin)
    publisher.wait_for_all_acked()


def publish(node: Node, publisher: Publisher, sample: int) -> None:
    """Write a sample."""
    message = JointState(name=['pivot'], position=[float(sample)], velocity=[0.0], effort=[0.0])
    message.header.stamp = node.get_clock().now().to_msg()
    publisher.publish(message)
