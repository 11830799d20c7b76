"""The answer to a call of a ROS service, waited for in a thread of the server."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rclpy.task import Future

PATIENCE = 5.0
"""Seconds."""


def answer_to(future: Future, whom: str) -> Any:
    """Return what a node answers; not for the thread in which the node of this process listens.

    Raises
    ------
    TimeoutError
        It does not.

    """
    came = threading.Event()
    future.add_done_callback(lambda _: came.set())
    if not came.wait(PATIENCE):
        raise TimeoutError(f'{whom} has not answered within {PATIENCE:g} s')
    return future.result()
