"""Quality of service of the graph's topics, and their message classes."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

STREAM = QoSProfile(
    history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.VOLATILE
)
"""Of numbered topics: nothing is dropped; a full writer waits."""
LATCHED = QoSProfile(
    depth=1,
    history=HistoryPolicy.KEEP_LAST,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
"""Of settings: whoever comes later still gets them."""
EVERY_LATCHED = QoSProfile(
    history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)
"""Of those who read settings: with the newest alone, one writer could hide from them what another has said."""
VIEW = QoSProfile(depth=1, history=HistoryPolicy.KEEP_LAST, reliability=ReliabilityPolicy.BEST_EFFORT)
"""Of what viewers look at: the newest will do."""


def message_class(type_name: str) -> Any:
    """Return the class of a message type such as `std_msgs/msg/Header`."""
    package, _, name = type_name.split('/')
    return getattr(import_module(f'{package}.msg'), name)
