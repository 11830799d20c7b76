"""The wait for a network interface that has just been connected: DDS looks for interfaces once, as it starts."""

from __future__ import annotations

import ctypes
import os
import select
import socket
import sys
import time
from contextlib import suppress

from kapitsa_ros.ros.reachability import PEERS, RANGE

_UP, _RUNNING, _LOWER_UP = 0x1, 0x40, 0x10000
"""Flags of <linux/if.h>: switched on, ready for packets, connected."""
_OF_INTERFACES = 1
"""RTMGRP_LINK of <linux/rtnetlink.h>: who hears of each change of an interface."""
_LONGEST = 65536
"""Bytes of a message of the system."""
_PATIENCE = 2.0
"""Seconds: Linux calls a connected interface ready within one, unless somebody has to log in to the network first."""


class _Address(ctypes.Structure):
    """The first members of `struct ifaddrs`."""


_Address._fields_ = [  # it points to its own kind
    ('next', ctypes.POINTER(_Address)),
    ('name', ctypes.c_char_p),
    ('flags', ctypes.c_uint),
]


def wait_for_network_interfaces() -> None:
    """Wait until connected interfaces are ready, for up to two seconds, where nodes may be on other machines.

    DDS leaves out an interface that is not ready when it starts, and does not look again: nodes of other machines were
    never found. One that does not become ready is named on stderr.
    """
    if (os.environ.get(RANGE) or 'LOCALHOST') == 'LOCALHOST' and not os.environ.get(PEERS):
        return
    with suppress(OSError), socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, socket.NETLINK_ROUTE) as changes:
        changes.bind((0, _OF_INTERFACES))
        deadline = time.monotonic() + _PATIENCE
        while _not_ready() and (left := deadline - time.monotonic()) > 0.0:
            if select.select([changes], [], [], left)[0]:
                changes.recv(_LONGEST)
    for name in _not_ready():
        sys.stderr.write(
            f'kapitsa: warning: the network interface {name} is connected and not ready: nodes that are reached '
            'through it are not found; start again when it is\n'
        )


def _not_ready() -> list[str]:
    """Return the names of interfaces that are connected and not ready, in order."""
    connected = _UP | _LOWER_UP
    return sorted({name for name, flags in interface_flags() if flags & (connected | _RUNNING) == connected})


def interface_flags() -> list[tuple[str, int]]:
    """Return the name of the interface and its flags, for each address, as DDS reads them (getifaddrs(3))."""
    library = ctypes.CDLL(None)
    first = ctypes.POINTER(_Address)()
    if library.getifaddrs(ctypes.byref(first)):
        return []
    found: list[tuple[str, int]] = []
    address = first
    try:
        while address:
            found.append((os.fsdecode(address.contents.name), address.contents.flags))
            address = address.contents.next
    finally:
        library.freeifaddrs(first)
    return found
