"""A ROS domain of its own for every rig."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

import domain_coordinator

from kapitsa_ros.rig.errors import RigError, UsageError

if TYPE_CHECKING:
    from collections.abc import Iterator

HIGHEST = 101
"""Domains above this reach into the ports that Linux gives to others."""


@contextmanager
def reserved_domain(requested: int | None = None) -> Iterator[int]:
    """Reserve a domain while the context lasts: the requested one, else ROS_DOMAIN_ID, else a free one.

    Raises
    ------
    UsageError
        ROS_DOMAIN_ID is no domain.
    RigError
        A rig runs in that domain already, or none is free.

    """
    if requested is None and (text := os.environ.get('ROS_DOMAIN_ID')):
        if not (text.isascii() and text.isdecimal()):  # rcl does not know other digits
            raise UsageError(f'ROS_DOMAIN_ID is {text!r}: give a number from 0 to {HIGHEST}')
        requested = int(text)
    if requested is not None and not (type(requested) is int and 0 <= requested <= HIGHEST):
        raise UsageError(f'ROS_DOMAIN_ID is {requested!r}: give a number from 0 to {HIGHEST}')
    reservation = domain_coordinator.domain_id(None if requested is None else lambda: requested)
    try:
        domain = reservation.__enter__()
    except RuntimeError as error:
        taken = 'no domain is free' if requested is None else f'a rig runs in domain {requested} already'
        raise RigError(f'{taken}: choose another ROS_DOMAIN_ID, or unset it to get a free one') from error
    try:
        yield domain
    finally:
        reservation.__exit__(None, None, None)
