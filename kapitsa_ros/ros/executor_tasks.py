"""Callbacks whose errors do not reach the executor: it runs handlers of events and of futures as tasks."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


def guarded(callback: Callable[..., Any], fail: Callable[[Exception], None]) -> Callable[..., Any]:
    """Return a callback that hands to `fail`, which raises nothing, what it raises.

    What a task raises, the events executor of rclpy 7.1 answers with a segmentation fault where it has one node (rclpy
    issue 1641).
    """

    @functools.wraps(callback)
    def call(*given: Any) -> Any:
        try:
            return callback(*given)
        except Exception as error:  # noqa: BLE001  # of every kind
            return fail(error)

    return call
