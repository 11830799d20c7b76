"""A rig whose nodes run and do not find one another, noticed and explained."""

from __future__ import annotations

import os
import time
from typing import TYPE_CHECKING

from kapitsa_ros.rig.errors import RigError

if TYPE_CHECKING:
    from kapitsa_ros.rig.node_group import NodeGroup

PATIENCE = 20.0
"""Seconds for which nodes that have all joined their domain may look for one another; two are common."""


class Formation:
    """Watches a rig until its first step."""

    def __init__(self, nodes: NodeGroup) -> None:
        self._nodes = nodes
        self._since: float | None = None

    def check(self) -> None:
        """Look whether the nodes should have found one another by now; called while no step has been made.

        Raises
        ------
        RigError
            They have not: the message says who waits for whom.

        """
        now = time.monotonic()
        if self._since is None and self._nodes.have_joined():
            self._since = now
        if self._since is not None and now - self._since > PATIENCE and (waits := self._nodes.who_waits()):
            raise RigError(f'the nodes do not find one another: {waits}; {_cause()}')


def _cause() -> str:
    """Return what the environment suggests."""
    if server := os.environ.get('ROS_DISCOVERY_SERVER'):
        return f'ROS_DISCOVERY_SERVER is {server}: start that server, or unset it'
    if profile := os.environ.get('FASTRTPS_DEFAULT_PROFILES_FILE'):
        return f'FASTRTPS_DEFAULT_PROFILES_FILE is {profile}: does it let them hear each other?'
    return 'does a firewall keep UDP from 127.0.0.1?'
