"""Where the command line's nodes are forked from: its own process, so that what both need is loaded once."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Iterator

OWN_PROCESS = object()
"""Of a click context: the program is `kapitsa` and no other, which might have threads, or something of DDS open."""


@contextmanager
def node_server(*, loads_first: bool = True) -> Iterator[None]:
    """Fork nodes, while this lasts, from a copy of this process.

    Parameters
    ----------
    loads_first
        Whether this process loads first what nodes need, as it needs the same. Else the copy does, beside this one.

    """
    from kapitsa_ros.rig.fork_server_process import fork_server  # noqa: PLC0415  # rclpy takes its time

    with fork_server(from_here=click.get_current_context().obj is OWN_PROCESS, loads_first=loads_first):
        yield
