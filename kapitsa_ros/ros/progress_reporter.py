"""How far the node that owns time is, told now and then."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.ros.diagnostics import progress_message, reporter_name
from kapitsa_ros.ros.throttle import REPORT_PERIOD, Throttle

if TYPE_CHECKING:
    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.ros.dataflow_node import DataflowNode
    from kapitsa_ros.ros.real_time_pacer import RealTimePacer


class ProgressReporter:
    """Publishes the progress of a node on `/diagnostics`, no more often than its readers need."""

    def __init__(self, node: DataflowNode, pace: RealTimePacer) -> None:
        self._name, self._publisher, self._pace = reporter_name(node), node.diagnostics, pace
        self._throttle = Throttle(REPORT_PERIOD)
        self._misses = 0

    def tell(self, step_id: StepId, stamp_ns: int, *, paused: bool | None = None) -> None:
        """Tell of the step just made, if it ends a run or the last report is old."""
        if self._throttle.due() or step_id.end:
            is_late = self._pace.misses > self._misses
            self._misses = self._pace.misses
            message = progress_message(self._name, step_id, stamp_ns, self._pace, is_late=is_late, paused=paused)
            self._publisher.publish(message)
