"""The motion as viewers see it: frames of the blocks, spread over the time until the next block comes.

A block holds 1000 samples a simulated second; a viewer can use some fifty a wall second. So it gets real samples at
even spacing, at the pace of the rig: at rate 1 five frames a step of 0.1 s, at rate 0.05 all hundred. The shaft turns
about as fast as frames come, and a viewer sees it as under a strobe; only a slow rate shows the shaking itself.
"""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING

from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.ros.frame import Frame
from kapitsa_ros.ros.throttle import PERIOD

if TYPE_CHECKING:
    from kapitsa_ros.physics.sampled_motion import SampledMotion

FRAME = 1 / 60
"""Least seconds of wall time between two frames of a block."""
SLOWEST = 3.0
"""Seconds of wall time: a block that comes later was made by hand or after a pause, and its end is shown at once."""


def frame_count(intervals: int, gap: float) -> int:
    """Return into how many equal parts to cut a block.

    Parameters
    ----------
    intervals
        Between the samples of the block.
    gap
        Seconds of wall time since the block before: so long this one will be on show.

    """
    if gap > SLOWEST:
        return 1
    most = min(intervals, int(gap / FRAME))
    return max((count for count in range(1, most + 1) if intervals % count == 0), default=1)


def frame_of(sample: int, due: float, stamp_ns: int, pivot: SampledMotion, motion: SampledMotion) -> Frame:
    """Return a sample of a block that begins at a stamp as a frame."""
    return Frame(
        due=due,
        stamp_ns=stamp_ns + sample * round(motion.period * SECOND),
        position=(float(pivot.position[sample]), float(motion.position[sample])),
        velocity=(float(pivot.rate[sample]), float(motion.rate[sample])),
    )


class FrameSchedule:
    """Holds the frames of the newest block; what is not shown when the next one comes is left out.

    Wall time (`now`) is that of a steady clock, s.
    """

    def __init__(self) -> None:
        self._frames: deque[Frame] = deque()
        self._since = -math.inf

    def wants(self, now: float) -> bool:
        """Whether a viewer could use another block by now."""
        return now - self._since >= PERIOD

    def wait_for_block(self, now: float) -> float:
        """Return the seconds until a viewer can use another block."""
        return max(self._since + PERIOD - now, 0.0)

    def take(self, now: float, stamp_ns: int, pivot: SampledMotion, motion: SampledMotion) -> None:
        """Cut a block that begins at a stamp into frames."""
        gap = now - self._since
        self._since = now
        intervals = motion.position.size - 1
        count = frame_count(intervals, gap)
        self._frames.clear()
        for number in range(count):
            # The end of each part: so the last frame before a pause is where time stands still.
            sample = (number + 1) * intervals // count
            due = now + (number * gap / count if number else 0.0)
            self._frames.append(frame_of(sample, due, stamp_ns, pivot, motion))

    def skip(self, now: float) -> None:
        """Show nothing of a block: nobody looks."""
        self._since = now
        self._frames.clear()

    def due(self, now: float) -> Frame | None:
        """Return the newest frame that is due and was not returned yet."""
        newest = None
        while self._frames and self._frames[0].due <= now:
            newest = self._frames.popleft()
        return newest

    def wait(self, now: float) -> float:
        """Return the seconds until the next frame is due."""
        return self._frames[0].due - now if self._frames else math.inf
