"""The environment of a node process: its domain, and loopback only unless the user requested for more."""

from __future__ import annotations

import os
import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING

from kapitsa_ros.resources import resource_path
from kapitsa_ros.ros.log_output import FORMAT, SWITCHES
from kapitsa_ros.ros.output_port import hold_output_port
from kapitsa_ros.ros.reachability import PEERS

if TYPE_CHECKING:
    from collections.abc import Iterator


_OF_LOG = {FORMAT, *SWITCHES}
"""How a node's lines look is not the user's to say where the rig reads them (`NodeProcess`)."""
_lock = threading.Lock()
"""Held while this module reads or changes the environment of the process, which all threads share."""
_added: dict[str, str] = {}
"""What the contexts under way have put into the environment."""
_contexts = 0
_profile = 'loopback.xml'
"""Of Fast DDS, for participants of this program and its nodes, unless they have peers elsewhere."""


def use_slow_heartbeats() -> None:
    """Have writers ask for acknowledgements once a second: for a program whose sessions are ended by a person.

    Nobody waits for the last acknowledgement there, and at rate 1 it saves a tenth of a rig's CPU time and of its
    program's.
    """
    global _profile  # noqa: PLW0603  # there is one a program
    _profile = 'loopback_slow_heartbeats.xml'


def node_environment(domain: int) -> dict[str, str]:
    """Return the environment for a node of a rig in a domain."""
    with _lock:
        plain = {name: value for name, value in os.environ.items() if name not in _OF_LOG}
        return {**plain, **loopback(), 'ROS_DOMAIN_ID': str(domain)}


@contextmanager
def on_loopback() -> Iterator[None]:
    """Let a participant that this process makes in the context keep to the interfaces of the nodes.

    DDS takes them from the environment of the process: contexts may overlap, and the last one to be left takes out what
    the first has put in.
    """
    global _contexts  # noqa: PLW0603  # as the environment is
    hold_output_port()
    with _lock:
        if not _contexts:
            _added.update(loopback())
            os.environ.update(_added)
        _contexts += 1
    try:
        yield
    finally:
        with _lock:
            _contexts -= 1
            if not _contexts:
                for name, value in _added.items():
                    if os.environ.get(name) == value:  # and not what somebody else has set since
                        del os.environ[name]
                _added.clear()


def loopback() -> dict[str, str]:
    """Return what the environment lacks to stay on this machine and those it names, unless it says something else."""
    requested = os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    if requested != 'LOCALHOST':
        return {}
    # The range alone keeps packets on this machine; the profile also closes the ports on other interfaces.
    profile = 'static_peers.xml' if os.environ.get(PEERS) else _profile
    path = str(resource_path('config', profile))
    settings = {'ROS_AUTOMATIC_DISCOVERY_RANGE': requested, 'FASTRTPS_DEFAULT_PROFILES_FILE': path}
    return {name: value for name, value in settings.items() if name not in os.environ}
