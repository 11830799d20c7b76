"""Names on the graph that ROS can use; a program that speaks DDS alone, or a client, may have made up others."""

from __future__ import annotations

from rclpy.exceptions import InvalidTopicNameException
from rclpy.validate_full_topic_name import validate_full_topic_name


def is_full_name(text: str) -> bool:
    """Whether a text is the full name of a topic, a service or a node."""
    try:
        validate_full_topic_name(text)
    except InvalidTopicNameException:
        return False
    return True
