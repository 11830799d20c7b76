"""Somebody does not answer: said once, and once more when it is over."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rclpy.node import Node

    from kapitsa_ros.network.step_id import StepId

PATIENCE = 3.0
"""Seconds of wall time for which a step may wait without a word."""


class StallWarning:
    """Watches how long the next step has been waiting for others."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._step: StepId | None = None
        self._since = 0.0
        self._said = False

    def note(self, step: StepId, awaited: Sequence[str]) -> None:
        """Note that a step is next, and the topics it waits for; looked at often, it speaks up in time."""
        now = time.monotonic()
        if step != self._step or not awaited:
            if self._said:
                self._node.get_logger().info(f'goes on at {step} after {now - self._since:.0f} s')
            self._step, self._since, self._said = step, now, False
        elif not self._said and now - self._since > PATIENCE:
            self._said = True
            self._node.get_logger().warning(f'{step} waits for {", ".join(awaited)}: silent for {PATIENCE:.0f} s')
