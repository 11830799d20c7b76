"""A ROS domain of its own for every rig."""

from __future__ import annotations

import os
from contextlib import contextmanager
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

import domain_coordinator

from kapitsa_ros.rig.errors import RigError, UsageError

if TYPE_CHECKING:
    from collections.abc import Iterator

HIGHEST = 101
"""Domains above this reach into the ports that Linux gives to others."""
_WANTED = f'give a number from 0 to {HIGHEST} (ports of higher ones are those that Linux gives to any program)'
_CHOSEN = range(1, 101)
"""Those that are chosen from: 0 is everybody's."""
_FIRST_PORT, _PORTS = 7400, 250
"""Of domain 0, and of each domain (RTPS specification, 9.6.1.1)."""


@contextmanager
def reserved_domain(requested: int | None = None) -> Iterator[int]:
    """Reserve a domain while the context lasts: the requested one, else ROS_DOMAIN_ID, else a free one.

    Free is a domain that nobody has reserved and in which nothing of DDS is open on this machine: the nodes of a rig
    that was killed take a moment to find that out, and other ROS programs reserve nothing.

    Raises
    ------
    UsageError
        ROS_DOMAIN_ID is no domain.
    RigError
        A rig runs in that domain already, or none is free.

    """
    if requested is None and (text := os.environ.get('ROS_DOMAIN_ID')):
        if not (text.isascii() and text.isdecimal()):  # rcl does not know other digits
            raise UsageError(f'ROS_DOMAIN_ID is {text!r}: {_WANTED}')
        requested = int(text)
    if requested is not None and not (type(requested) is int and 0 <= requested <= HIGHEST):
        raise UsageError(f'ROS_DOMAIN_ID is {requested!r}: {_WANTED}')
    candidates = cycle([requested] if requested is not None else _without_participants())
    reservation = domain_coordinator.domain_id(lambda: next(candidates))
    try:
        domain = reservation.__enter__()
    except RuntimeError as error:
        taken = 'no domain is free' if requested is None else f'a rig runs in domain {requested} already'
        raise RigError(f'{taken}: choose another ROS_DOMAIN_ID, or unset it to get a free one') from error
    try:
        yield domain
    finally:
        reservation.__exit__(None, None, None)


def _without_participants() -> list[int]:
    """Return the domains in which no participant of DDS has a port open, as far as the system tells."""
    try:
        lines = Path('/proc/net/udp').read_text(encoding='ascii').splitlines()[1:]
    except OSError:
        return list(_CHOSEN)
    # the second column is the local address, as in 0100007F:1CF2
    in_use = {(int(line.split()[1].split(':')[1], 16) - _FIRST_PORT) // _PORTS for line in lines}
    return [domain for domain in _CHOSEN if domain not in in_use]
