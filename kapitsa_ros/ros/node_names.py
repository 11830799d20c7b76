"""Names of the nodes at the ends of a topic."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rclpy.topic_endpoint_info import TopicEndpointInfo

UNKNOWN = '_NODE_NAME_UNKNOWN_'
"""As rmw has it of a node whose topics were heard of before its name was."""
NAMELESS = 'a node without a name yet'


def node_names(ends: Iterable[TopicEndpointInfo]) -> list[str]:
    """Return the names in order; a node that has said none yet is called that."""
    return sorted(NAMELESS if end.node_name == UNKNOWN else end.node_name for end in ends)
