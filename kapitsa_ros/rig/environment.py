"""The environment of a node process: its domain, and loopback only unless the user asked for more."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

from kapitsa_ros.resources import resource_path

if TYPE_CHECKING:
    from collections.abc import Iterator

RIG_PID = 'KAPITSA_RIG_PID'
"""A node whose parent is no longer this process ends: nothing outlives its rig."""


def node_environment(domain: int) -> dict[str, str]:
    """Return the environment for a node of a rig in a domain."""
    return {**os.environ, **loopback(), 'ROS_DOMAIN_ID': str(domain), RIG_PID: str(os.getpid())}


@contextmanager
def on_loopback() -> Iterator[None]:
    """Let a participant that this process makes in the context keep to the interfaces of the nodes."""
    added = loopback()
    os.environ.update(added)
    try:
        yield
    finally:
        for name in added:
            del os.environ[name]


def loopback() -> dict[str, str]:
    """Return what the environment lacks to stay on this machine, unless it says something else."""
    asked = os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    if asked != 'LOCALHOST':
        return {}
    # The range alone keeps packets on this machine; the profile also closes the ports on other interfaces.
    profile = str(resource_path('config', 'loopback.xml'))
    wanted = {'ROS_AUTOMATIC_DISCOVERY_RANGE': asked, 'FASTRTPS_DEFAULT_PROFILES_FILE': profile}
    return {name: value for name, value in wanted.items() if name not in os.environ}
