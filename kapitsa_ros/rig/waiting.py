"""Waiting for what a rig says, as long as its nodes live."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any

from kapitsa_ros.rig.errors import RigError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kapitsa_ros.rig.node_group import NodeGroup
    from kapitsa_ros.ros.rig_client import RigClient

_LOOK_PERIOD = 0.1
"""Seconds between two looks at the graph: who joins it does not announce it with a message."""
_LONGEST_WAIT = 60.0
"""Seconds; `poll` takes no endless ones."""


def wait_until(  # noqa: PLR0917  # the order is that of a sentence
    found: Callable[[], Any],
    client: RigClient,
    nodes: NodeGroup,
    timeout: float,
    what: str,
    topics: Sequence[str] | None = None,
) -> Any:
    """Call `found` whenever there is news until it returns something else than None, and return that.

    Parameters
    ----------
    found
        Looks for what is waited for.
    client, nodes
        Who listens, and who speaks.
    timeout
        Seconds of wall time.
    what
        Is waited for, in words.
    topics
        Whose messages are news; None: of all, and whatever else changes on the graph.

    Raises
    ------
    RigError
        A node died, or the session is over.
    TimeoutError
        It did not come in time; the message says for whom nodes wait, or what was heard too late.

    """
    client.heed(topics)
    look_period = _LOOK_PERIOD if topics is None else _LONGEST_WAIT
    deadline = time.monotonic() + timeout
    ended = False
    while True:
        client.clear_news()
        client.check()
        if ended:
            client.refuse_disputed()
        value = found()
        if value is not None:
            return value
        if ended:
            raise RigError('the session is over: {what} will not come', what=what)
        left = deadline - time.monotonic()
        if left <= 0 or math.isnan(left):
            has_begun = any(client.seen.values())
            why = client.told_missed(topics or ()) if has_begun else nodes.who_waits()
            raise TimeoutError(f'{what} did not come within {timeout} s{why and f": {why}"}')
        ended = nodes.wait(min(left, look_period), client.news)
