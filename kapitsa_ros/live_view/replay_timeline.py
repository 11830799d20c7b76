"""Recorded runs laid end to end: each is stamped with a day of its own, and a slider over days would show nothing."""

from __future__ import annotations

from bisect import bisect_right
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING

from kapitsa_ros.network.step_clock import SECOND

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.recording.reader import RunBag


class ReplayTimeline:
    """The time of a replay: it begins with the first run, and has no gaps.

    Parameters
    ----------
    bags
        One or more, in the order in which they are played.

    Raises
    ------
    ValueError
        Two of them have the same stamps, and a message would not tell of which it is.

    """

    def __init__(self, bags: Sequence[RunBag]) -> None:
        lengths = [bag.last_stamp_ns - bag.first_stamp_ns for bag in bags]
        begins = accumulate(lengths[:-1], initial=bags[0].first_stamp_ns)
        self._runs = sorted(
            (bag.first_stamp_ns, bag.last_stamp_ns, begin) for bag, begin in zip(bags, begins, strict=True)
        )
        if any(before[1] >= after[0] for before, after in pairwise(self._runs)):
            raise ValueError('two of these runs have the same number: replay one of them at a time')
        self.range_ns = bags[0].first_stamp_ns, bags[0].first_stamp_ns + sum(lengths)
        """Beginning and end."""

    def time_at(self, stamp_ns: int) -> int:
        """Return the time of a stamp, ns; what is stamped between two runs comes at the end of the one before."""
        first, last, begin = self._runs[max(0, bisect_right(self._runs, (stamp_ns, 2**63, 0)) - 1)]
        return begin + min(max(stamp_ns, first), last) - first

    def seconds_at(self, time_ns: int) -> float:
        """Return the place of a time in the runs as the player counts them, s."""
        begin, end = self.range_ns
        return (min(max(time_ns, begin), end) - begin) / SECOND
