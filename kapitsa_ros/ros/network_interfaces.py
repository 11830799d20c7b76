"""The wait for a network interface that has just been connected: DDS looks for interfaces once, as it starts."""

from __future__ import annotations

import ctypes
import os
import time

from kapitsa_ros.ros.reachability import PEERS, RANGE

_UP, _RUNNING, _LOWER_UP = 0x1, 0x40, 0x10000
"""Flags of <linux/if.h>: switched on, ready for packets, connected."""
_PATIENCE = 2.0
"""Seconds: Linux calls a connected interface ready within one, unless somebody has to log in to the network first."""
_LOOK_PERIOD = 0.02


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
    never found.
    """
    if (os.environ.get(RANGE) or 'LOCALHOST') == 'LOCALHOST' and not os.environ.get(PEERS):
        return
    deadline = time.monotonic() + _PATIENCE
    while any(_is_becoming_ready(flags) for flags in _interface_flags()) and time.monotonic() < deadline:
        time.sleep(_LOOK_PERIOD)  # the system tells of it by netlink messages alone


def _is_becoming_ready(flags: int) -> bool:
    return flags & (_UP | _LOWER_UP | _RUNNING) == _UP | _LOWER_UP


def _interface_flags() -> list[int]:
    """Return the flags of each address of an interface, as DDS reads them (getifaddrs(3))."""
    library = ctypes.CDLL(None)
    first = ctypes.POINTER(_Address)()
    if library.getifaddrs(ctypes.byref(first)):
        return []
    flags: list[int] = []
    address = first
    try:
        while address:
            flags.append(address.contents.flags)
            address = address.contents.next
    finally:
        library.freeifaddrs(first)
    return flags
