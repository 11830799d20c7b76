"""The lock of a topic: one process of this machine writes it, whatever DDS has found so far."""

from __future__ import annotations

import errno
import hashlib
import socket
from contextlib import closing, contextmanager
from typing import TYPE_CHECKING

from kapitsa_ros.ros.errors import NodeError

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def topic_lock(topic: str, domain: int) -> Iterator[None]:
    """Hold the lock of a topic while the context lasts, or as long as the process lives.

    DDS finds who else writes a topic within seconds, and later where a process stands still. The lock is a name of
    Linux's abstract sockets: it leaves no file, ends with its process however that ends, and is of one network
    namespace, as the loopback device is. Where the system has no such names, what DDS finds has to do.

    Parameters
    ----------
    topic
        Its name on the graph.
    domain
        ROS domain.

    Raises
    ------
    NodeError
        Another process holds it.

    """
    name = hashlib.sha256(f'{domain} {topic}'.encode()).hexdigest()  # a topic may have more letters than a socket
    with closing(socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)) as holder:
        try:
            holder.bind(f'\0kapitsa_ros/{name}')
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                raise NodeError(
                    f'another process of this machine writes {topic} in domain {domain}: a rig is there already; '
                    'choose another ROS_DOMAIN_ID or stop it'
                ) from error
        yield
