"""What of the graph the view has not used, said now and then."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.errors import shorten

if TYPE_CHECKING:
    from rclpy.node import Node

_PERIOD = 5.0
"""Seconds between two lines."""


def say_refused(node: Node, why: str) -> None:
    """Say on the terminal that a message of somebody was not used, unless something was said just now."""
    node.get_logger().warning(f'refused: {shorten(why)}', throttle_duration_sec=_PERIOD)
