"""Names of the nodes at the ends of a topic."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from rclpy.topic_endpoint_info import TopicEndpointInfo

UNKNOWN = '_NODE_NAME_UNKNOWN_'
"""As rmw has it of a node whose topics were heard of before its name was."""
NAMELESS = 'a node without a name yet'
NAMING = 1.0
"""Seconds after which the graph knows the name of a node whose topics it knows: it does so a moment later."""
_LOOK_PERIOD = 0.01
"""Seconds between two looks: rclpy tells nobody of a change of the graph."""


def node_names(ends: Iterable[TopicEndpointInfo]) -> list[str]:
    """Return the names in order; a node that has said none yet is called that."""
    return sorted(NAMELESS if end.node_name == UNKNOWN else end.node_name for end in ends)


def wait_for_names(look: Callable[[], list[str]]) -> list[str]:
    """Return the names that `look` returns once all are known, or those it does after `NAMING` seconds.

    For the line by which a session ends, which has to name who is at fault: nothing else happens meanwhile.
    """
    deadline = time.monotonic() + NAMING
    while NAMELESS in (names := look()) and time.monotonic() < deadline:
        time.sleep(_LOOK_PERIOD)
    return names
