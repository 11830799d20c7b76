"""At what time a client of the view sees a message: simulated time, in a replay that of the runs laid end to end."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.network.cdr import stamp_of
from kapitsa_ros.network.errors import WireError

if TYPE_CHECKING:
    from kapitsa_ros.live_view.replay_timeline import ReplayTimeline


class ViewClock:
    """The time of the view.

    Parameters
    ----------
    timeline
        Of a replay; None: simulated time is shown as it is.

    """

    def __init__(self, timeline: ReplayTimeline | None) -> None:
        self._timeline = timeline
        self.now_ns: int | None = None if timeline is None else timeline.range_ns[0]
        """None until the owner of time has spoken."""

    def set(self, stamp_ns: int) -> int | None:
        """Take a simulated time as the present; return when that is in the view, None: never."""
        time_ns = self.shown(stamp_ns)
        if time_ns is not None:
            self.now_ns = time_ns
        return time_ns

    def time_of(self, raw: bytes, *, has_header: bool) -> int | None:
        """Return when a message is shown: at its stamp, or else now; None: it is not known yet, or no message."""
        if not has_header:
            return self.now_ns
        try:
            return self.shown(stamp_of(raw))
        except WireError:
            return None

    def shown(self, stamp_ns: int) -> int | None:
        """Return when a simulated time is in the view; None: never, as the rig has no time before 0."""
        if stamp_ns < 0:
            return None
        return stamp_ns if self._timeline is None else self._timeline.time_at(stamp_ns)
