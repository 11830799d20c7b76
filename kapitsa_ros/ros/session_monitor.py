"""The node that follows a session from the rig's own process: progress reports and results."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

from diagnostic_msgs.msg import DiagnosticArray

from kapitsa_ros.network.cdr import stamp_of
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import RESULT, SESSION_MONITOR
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.network.step_id import ends_session
from kapitsa_ros.ros.diagnostics import is_progress
from kapitsa_ros.ros.listener_node import ListenerNode
from kapitsa_ros.ros.numbered_subscription import NumberedSubscription
from kapitsa_ros.ros.real_time_pacer import RealTimePacer
from kapitsa_ros.ros.time_control_client import TimeControlClient

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.network.step_id import StepId


PROGRESS = ('jigsaw: progress', 'player: progress')
"""Names of the reports of those that own time; anybody may speak on `diagnostics`."""


class SessionMonitor(ListenerNode):
    """Keeps the newest progress and the newest results. A context: it listens while it lasts.

    Parameters
    ----------
    domain
        ROS domain of the rig.
    on_progress
        Called from another thread with the values of each progress report.

    """

    def __init__(self, domain: int, on_progress: Callable[[dict[str, str]], None] | None = None) -> None:
        self.progress: dict[str, str] = {}
        """Values of the newest report."""
        self.runs: list[dict[str, Any]] = []
        """Results of each run, in order, as the analyser published them."""
        self.experiment: dict[str, Any] = {}
        """Results of all runs so far together."""
        self._ended = self._over = False
        self._pace = RealTimePacer(0.0)
        self._news = threading.Condition()
        self._on_progress = on_progress
        super().__init__(SESSION_MONITOR.name, domain)
        self._node.create_subscription(DiagnosticArray, '/diagnostics', self._take_progress, 10)
        self._results = NumberedSubscription(self._node, RESULT, self._take_result, lambda _: None, self.fail)

    @property
    def has_one_source(self) -> bool:
        """Whether nobody but the analyser was ever there to say its results."""
        return self._results.has_had_one_writer

    def time_control(self, owner: str) -> TimeControlClient:
        """Return a client of the node that owns time."""
        return TimeControlClient(self._node, owner)

    def wait_for_end(self, timeout: float = 5.0) -> None:
        """Wait for the analyser's last results.

        Raises
        ------
        NodeError
            A second writer has said some, too.
        TimeoutError
            They did not come.

        """
        with self._news:
            came = self._news.wait_for(lambda: self.is_complete or self._failure or self._dispute, timeout)
            self.check()
            self.refuse_disputed()
            if not came:
                raise TimeoutError('the rig did not say that the session is over')

    @property
    def session_over(self) -> bool:
        """Whether the owner of time, or the last result, says that no run follows: a report of progress may be lost."""
        return self._over or self._ended

    @property
    def realtime_factor(self) -> float:
        """Simulated over wall seconds, by the analyser's steps: what is said of progress anybody may have said."""
        return self._pace.realtime_factor

    @property
    def is_complete(self) -> bool:
        """Whether the last results have come."""
        return self._ended

    def wait_for_progress(self, timeout: float) -> dict[str, str]:
        """Wait for the next report of progress and return its values.

        Raises
        ------
        TimeoutError
            None came.

        """
        with self._news:
            known = self.progress
            came = self._news.wait_for(lambda: self.progress is not known or self._failure, timeout)
            self.check()
            if not came:
                raise TimeoutError(f'no progress within {timeout} s')
            return self.progress

    def wake(self) -> None:
        """Make whoever waits look again."""
        with self._news:
            self._news.notify_all()

    def _take_progress(self, message: DiagnosticArray) -> None:
        for status in message.status:
            values = {pair.key: pair.value for pair in status.values}
            if status.name in PROGRESS and is_progress(values):
                with self._news:
                    self._over = self._over or values['session_over'] == 'True'
                    self.progress = values
                    self._news.notify_all()
                if self._on_progress is not None:
                    self._on_progress(self.progress)

    def _take_result(self, step_id: StepId, raw: bytes) -> None:
        try:
            results = {} if RESULT.codec.is_silence(raw) else RESULT.decode(raw)
        except WireError:
            results = {}  # not the analyser's: it says nothing this cannot read
        with self._news:
            self._pace.count(stamp_of(raw) / SECOND)
            for name, values in results.items():
                if name == 'experiment':
                    self.experiment = dict(values)
                else:
                    self.runs.append(dict(values))
            self._ended = self._ended or ends_session(step_id)
            self._news.notify_all()
