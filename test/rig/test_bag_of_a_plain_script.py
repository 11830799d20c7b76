"""A recording by a script that knows ROS and nothing of this package gives the slow frequency, its gaps counted."""

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

SCRIPT = """
import math, random, sys, time
import rclpy
from rclpy.qos import QoSProfile
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import JointState

chance = random.Random(16338)
rclpy.init()
node = rclpy.create_node('encoder')
publisher = node.create_publisher(JointState, 'encoder/angle', QoSProfile(depth=1000))
with Writer(sys.argv[1], version=9, storage_plugin=StoragePlugin.MCAP) as writer:
    store = get_typestore(Stores.ROS2_JAZZY)
    link = writer.add_connection('/encoder/angle', 'sensor_msgs/msg/JointState', typestore=store)
    heard = []
    def hear(raw):
        writer.write(link, time.time_ns(), raw)
        heard.append(raw)
    node.create_subscription(JointState, 'encoder/angle', hear, QoSProfile(depth=1000), raw=True)
    while not publisher.get_subscription_count():
        rclpy.spin_once(node, timeout_sec=0.1)
    begin, sent = time.time(), 0
    for number in range(4500):
        # Never two in a row: the width of a gap is then known.
        if number % 2 and 0 < number < 4499 and chance.random() < 0.02:
            continue
        at = 0.002 * number + chance.gauss(0.0, 1e-5)
        slow = 0.01 * math.cos(2 * math.pi / 0.8 * at)
        message = JointState(name=['rod'], position=[slow * (1 + 0.05 * math.cos(2500 * math.pi / 30 * at))])
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(round((begin + at) * 1e9), 10**9)
        publisher.publish(message)
        sent += 1
        while len(heard) < sent:
            rclpy.spin_once(node, timeout_sec=1.0)
print(4500 - sent)
rclpy.shutdown()
"""


@pytest.mark.slow
def test_it_gives_the_slow_frequency_and_its_gaps(tmp_path: Path, domain: int, kapitsa: Callable[..., Any]) -> None:
    environment = os.environ | {'ROS_DOMAIN_ID': str(domain)}
    command = [sys.executable, '-c', SCRIPT, str(tmp_path / 'bag')]
    said = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=True).stdout
    done = kapitsa('analyse', tmp_path / 'bag', '--joint', 'rod', '--speed', '2500', '--json')
    [run] = done.json['runs']
    dropped = int(said)
    assert run['slow_rpm'] == pytest.approx(75.0, rel=1e-3)
    assert (run['samples'], run['gaps']) == (4500 - dropped, dropped)
    assert dropped > 20
    gaps = re.search(r': (\d+) gaps, in which (\S+) s are missing', done.err)
    assert gaps is not None
    assert (int(gaps[1]), float(gaps[2])) == (dropped, pytest.approx(0.002 * dropped, rel=0.01))
