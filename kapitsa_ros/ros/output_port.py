"""The port that keeps a transport of Fast DDS from sending what another one sends already (see config/loopback.xml)."""

from __future__ import annotations

import os
import socket
from contextlib import suppress

OUTPUT_PORT = 7399
"""`output_port` in config/loopback.xml and config/static_peers.xml."""
_holders: list[int] = []
"""The descriptor of this process's socket, once it has one; the system closes it."""


def hold_output_port() -> None:
    """Hold the port for as long as this process lives; before it opens DDS.

    All processes that hold it share it; Fast DDS does not, and finds it taken. Were it free for a moment, a transport
    would begin to send in the middle of a session, and complain.
    """
    if _holders:
        return
    holder = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    holder.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    with suppress(OSError):  # another user's rig holds it: it is taken all the same
        holder.bind(('127.0.0.1', OUTPUT_PORT))
    _holders.append(holder.detach())


def _let_go() -> None:
    while _holders:
        os.close(_holders.pop())


os.register_at_fork(after_in_child=_let_go)  # whose files are closed: it holds the port itself
