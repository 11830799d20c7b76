"""The steps of recorded runs, one run after the other."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import count, groupby
from typing import TYPE_CHECKING

from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.registry import COMMAND, REPLAYED
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.network.step_id import StepId

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kapitsa_ros.network.run import Run
    from kapitsa_ros.recording.reader import RunBag


@dataclass(frozen=True, kw_only=True)
class PlayedStep:
    """The messages of one step, or of the end of a run."""

    index: int
    """Counted over all runs."""
    id: StepId
    stamp_ns: int
    seconds: float
    """From the beginning of the first run, the runs laid end to end."""
    bag: RunBag
    messages: dict[str, bytes]
    """By topic; none for the end of a run that was cut off."""


class Playback:
    """The runs of a replay.

    Parameters
    ----------
    bags
        One or more, in the order in which they are played.

    """

    def __init__(self, bags: Sequence[RunBag]) -> None:
        self._bags = tuple(bags)

    @property
    def duration(self) -> float:
        """Of all runs together, s."""
        return sum(_duration(bag) for bag in self._bags)

    def runs(self, end: float) -> list[Run]:
        """Return what is played of the runs until a place, s; the last may be cut off there.

        Raises
        ------
        BagError
            A file is damaged.

        """
        found: list[Run] = []
        before = 0.0
        for bag in self._bags:
            if before > end:
                break
            found.append(bag.run_before(_first_step_after(bag, before, end)))
            before += _duration(bag)
        return found

    def steps(self) -> Iterator[PlayedStep]:
        """Yield the steps of every run from the first on, and the end of each.

        Raises
        ------
        BagError
            A file is damaged.

        """
        number, before = count(), 0.0
        names = [topic.name for topic in REPLAYED]
        for bag in self._bags:
            step_id, stamp = StepId(0, 0), bag.first_stamp_ns
            for step_id, step in groupby(bag.raw(*names), key=lambda message: read_step_id(message[2])):
                messages = {}
                for topic, stamp, raw in step:  # noqa: B007
                    messages[topic] = raw
                yield PlayedStep(
                    index=next(number),
                    id=step_id,
                    stamp_ns=stamp,
                    seconds=before + (stamp - bag.first_stamp_ns) / SECOND,
                    bag=bag,
                    messages=messages,
                )
            before += _duration(bag)
            if not step_id.end:
                end = StepId(step_id.run, step_id.step + 1, end=True)
                yield PlayedStep(index=next(number), id=end, stamp_ns=stamp, seconds=before, bag=bag, messages={})


def _first_step_after(bag: RunBag, begin: float, end: float) -> float:
    """Return the first step of a bag after a place, where the bag begins at another; infinity where there is none."""
    after = (
        read_step_id(raw).step
        for _, stamp, raw in bag.raw(COMMAND.name)
        if begin + (stamp - bag.first_stamp_ns) / SECOND > end
    )
    return next(after, math.inf)


def _duration(bag: RunBag) -> float:
    return (bag.last_stamp_ns - bag.first_stamp_ns) / SECOND
