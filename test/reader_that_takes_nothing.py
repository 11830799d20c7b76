"""A reader in a process of its own that matches a numbered topic and never takes what is said there."""

from __future__ import annotations

import os
import subprocess
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

PROGRAM = """
import sys
import rclpy
from rclpy.node import Node
from kapitsa_ros.network.registry import TOPICS
from kapitsa_ros.ros.qos import STREAM, message_class
domain, name, topic = sys.argv[1:]
rclpy.init(domain_id=int(domain))
[kind] = [message_class(each.type) for each in TOPICS if each.name == topic]
node = Node(name)
node.create_subscription(kind, topic, print, STREAM, raw=True)
sys.stdin.read()
"""
PROFILE = """<dds xmlns="http://www.eprosima.com"><profiles>
<data_reader profile_name="short" is_default_profile="true"><topic><resourceLimitsQos><max_samples>10</max_samples>
<max_instances>10</max_instances><max_samples_per_instance>10</max_samples_per_instance>
<allocated_samples>1</allocated_samples></resourceLimitsQos></topic></data_reader></profiles></dds>"""
"""Of a reader that has room for ten messages, and tells DDS so while it takes none."""


@contextmanager
def reader_that_takes_nothing(topic: str, name: str, domain: int, folder: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Start it; it is ended with the context. In the folder it gets its profile."""
    profile = folder / 'short.xml'
    profile.write_text(PROFILE, encoding='utf-8')
    reader = subprocess.Popen(
        [sys.executable, '-c', PROGRAM, str(domain), name, topic],
        stdin=subprocess.PIPE,
        env=os.environ | {'FASTRTPS_DEFAULT_PROFILES_FILE': str(profile)},
    )
    try:
        yield reader
    finally:
        reader.kill()
        reader.communicate()
