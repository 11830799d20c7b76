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
def reserved_domain(wanted: int | None = None) -> Iterator[int]:
    """Reserve a domain while the context lasts: the one wanted, else ROS_DOMAIN_ID, else a free one.

    Raises
    ------
    UsageError
        ROS_DOMAIN_ID is no domain.
    RigError
        A rig runs in that domain already, or none is free.

    """
    if wanted is None and (text := os.environ.get('ROS_DOMAIN_ID')):
        if not text.isdecimal():
            raise UsageError(f'ROS_DOMAIN_ID is {text!r}: give a number from 0 to {HIGHEST}')
        wanted = int(text)
    if wanted is not None and not 0 <= wanted <= HIGHEST:
        raise UsageError(f'ROS_DOMAIN_ID is {wanted}: give a number from 0 to {HIGHEST}')
    reservation = domain_coordinator.domain_id(None if wanted is None else lambda: wanted)
    try:
        domain = reservation.__enter__()
    except RuntimeError as error:
        taken = 'no domain is free' if wanted is None else f'a rig runs in domain {wanted} already'
        raise RigError(f'{taken}: choose another ROS_DOMAIN_ID, or unset it to get a free one') from error
    try:
        yield domain
    finally:
        reservation.__exit__(None, None, None)
