"""Rigs in namespaces share a domain: each keeps to its own topics, and what is everybody's tells them apart."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger

from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.rig.environment import node_environment, on_loopback

pytestmark = pytest.mark.xdist_group('processes')
REPORTERS = {'/left/player', '/left/analyser', '/right/player', '/right/analyser'}
BAG = Path(__file__).parents[2] / 'bags' / 'run_01_2240rpm'


def started(role: str, namespace: str, domain: int, *arguments: str) -> subprocess.Popen[bytes]:
    told = ['-r', f'__ns:=/{namespace}', '-p', 'expect:=[player, analyser]', *arguments]
    command = [sys.executable, '-m', 'kapitsa_ros', 'node', role, '--ros-args', *told]
    return subprocess.Popen(command, env=node_environment(domain))


def test_two_replays_in_one_domain(domain: int, eventually: Callable[[Callable[[], Any]], None]) -> None:
    context = Context()
    with on_loopback():  # the first node of a process opens DDS, for good
        rclpy.init(context=context, domain_id=domain)
        node = Node('observer', context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    said: dict[str, DiagnosticStatus] = {}
    stamps: list[int] = []

    def take(message: DiagnosticArray) -> None:
        said.update({status.name: status for status in message.status})
        stamps.append(message.header.stamp.sec * SECOND)

    def heard() -> set[str]:
        return {name.partition(':')[0] for name in said}

    node.create_subscription(DiagnosticArray, '/diagnostics', take, 100)
    resume = [node.create_client(Trigger, f'/{side}/player/resume') for side in ('left', 'right')]
    played = ['-p', f'bags:=[{BAG}]', '-p', 'start_paused:=true', '-p', 'rate:=0.0']
    processes = [
        started('player', 'left', domain, *played),
        started('analyser', 'left', domain),
        started('player', 'right', domain, *played, '-r', '/clock:=/right/clock'),
        started('analyser', 'right', domain),
    ]
    try:
        eventually(lambda: executor.spin_once(timeout_sec=0.1) or all(reporter in heard() for reporter in REPORTERS))
        for client in resume:
            eventually(lambda client=client: executor.spin_once(timeout_sec=0.1) or client.service_is_ready())
            client.call_async(Trigger.Request())
        eventually(lambda: executor.spin_once(timeout_sec=0.1) or None not in [each.poll() for each in processes])
        assert [each.returncode for each in processes] == [0, 0, 0, 0]
    finally:
        for process in processes:
            process.kill()
            process.wait()
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()
    assert heard() == REPORTERS
    assert all(status.level == DiagnosticStatus.OK for status in said.values())
    assert all(DAY <= stamp <= 2 * DAY for stamp in stamps)  # all of one clock, that of the runs
