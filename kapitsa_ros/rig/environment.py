"""The environment of a node process: its domain, and loopback only unless the user asked for more."""

from __future__ import annotations

import os

from kapitsa_ros.share import share_path

RIG_PID = 'KAPITSA_RIG_PID'
"""A node whose parent is no longer this process ends: nothing outlives its rig."""


def node_environment(domain: int) -> dict[str, str]:
    """Return the environment for a node of a rig in a domain."""
    environment = dict(os.environ)
    environment['ROS_DOMAIN_ID'] = str(domain)
    environment[RIG_PID] = str(os.getpid())
    if environment.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST') == 'LOCALHOST':
        # The range alone keeps packets on this machine; the profile also closes the other interfaces' sockets.
        environment.setdefault('FASTRTPS_DEFAULT_PROFILES_FILE', str(share_path('config', 'loopback.xml')))
    return environment
