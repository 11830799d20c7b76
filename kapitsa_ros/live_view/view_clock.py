"""At what time a client of the view sees a message: simulated time, in a replay that of the runs laid end to end."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.network.cdr import stamp_of
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.step_clock import SECOND

if TYPE_CHECKING:
    from kapitsa_ros.live_view.replay_timeline import ReplayTimeline

_END = 2**31 * SECOND
"""ns; the seconds of a stamp have 32 bits."""


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

    def set(self, stamp_ns: int) -> int:
        """Take a simulated time as the present; return when that is in the view; ValueError: it is none of a rig."""
        self.now_ns = self.shown(stamp_ns)
        return self.now_ns

    def time_of(self, raw: bytes, *, has_header: bool) -> int | None:
        """Return when a message is shown: at its stamp, or else now; None: it is not known yet, or no message.

        Raises
        ------
        ValueError
            Its stamp is no time of a rig.

        """
        if not has_header:
            return self.now_ns
        try:
            return self.shown(stamp_of(raw))
        except WireError:
            return None

    def shown(self, stamp_ns: int) -> int:
        """Return when a simulated time is in the view; ValueError: no rig has it, or no message can."""
        if not 0 <= stamp_ns < _END:
            raise ValueError(f'{stamp_ns / SECOND:g} s is no time of a rig')
        return stamp_ns if self._timeline is None else self._timeline.time_at(stamp_ns)
