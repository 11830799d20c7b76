"""Where the environment alone shows that nodes cannot find one another: said before one starts."""

from __future__ import annotations

import os
import socket
from pathlib import Path

from kapitsa_ros.ros.errors import SettingError

RANGE, PEERS = 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_STATIC_PEERS'
PROFILE, DOMAIN = 'FASTRTPS_DEFAULT_PROFILES_FILE', 'ROS_DOMAIN_ID'
_RANGES = ('LOCALHOST', 'SUBNET', 'SYSTEM_DEFAULT')
HIGHEST_DOMAIN = 232
"""Domains above this have no port."""
_SOME_PORT = 7400


def refuse_unreachable() -> None:
    """Look at what the environment says of discovery, and at the loopback interface.

    Raises
    ------
    SettingError
        No node could be made, or none would find another.

    """
    asked = os.environ.get(RANGE) or 'LOCALHOST'
    if asked not in _RANGES:
        raise SettingError(
            f'{RANGE} is {asked}: nodes do not find one another so; unset it, or give one of {", ".join(_RANGES)}'
        )
    domain = os.environ.get(DOMAIN) or '0'
    if not (domain.isascii() and domain.isdecimal()) or int(domain) > HIGHEST_DOMAIN:  # rcl knows no other digits
        raise SettingError(f'{DOMAIN} is {domain}: give a number from 0 to {HIGHEST_DOMAIN}')
    profile = os.environ.get(PROFILE)
    if profile and not os.access(profile, os.R_OK):
        why = 'cannot be read' if Path(profile).exists() else 'is not there'
        raise SettingError(f'{PROFILE} names {profile}, which {why}: unset it, or give the path of a profile')
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(('127.0.0.1', _SOME_PORT))  # sends nothing
        except OSError as error:
            raise SettingError(
                f'the loopback interface is down ({error.strerror}), nodes cannot talk: ip link set lo up'
            ) from error
