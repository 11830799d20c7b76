"""Where the messages of one run lie, by topic and step."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.network.registry import REPLAYED, STROBE_READING, writer_of
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.recording.step_map import StepMap

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from kapitsa_ros.recording.digest import Group


@dataclass(eq=False)
class RunIndex:
    """The messages of one run that stand in a bag, each once: their numbers in `MessageTable`."""

    number: int
    begins: int
    """Number of the first message."""
    steps: dict[str, StepMap] = field(default_factory=lambda: defaultdict(StepMap))
    """By topic and step."""
    ends: dict[str, StepMap] = field(default_factory=lambda: defaultdict(StepMap))
    """Messages that say that the run is over before their step."""
    groups: list[Group] = field(default_factory=list)
    repeated: int = 0
    """Messages that stand more than once, each the same."""
    conflicts: set[tuple[str, int]] = field(default_factory=set)
    """Topic and step of which two messages say different things."""

    def find(self, topic: str, step_id: StepId) -> int | None:
        """Return the number of a message; None where there is none."""
        return (self.ends if step_id.end else self.steps)[topic].get(step_id.step)

    def put(self, topic: str, step_id: StepId, message: int) -> None:
        """Note where a message lies."""
        (self.ends if step_id.end else self.steps)[topic].put(step_id.step, message)

    def drop(self, topic: str, first: int, last: int) -> None:
        """Leave out what stands on a topic from a step to another."""
        for found in (self.steps[topic], self.ends[topic]):
            found.drop(first, last)

    @property
    def present(self) -> list[str]:
        """Names of the topics of a run that have a message."""
        return [topic.name for topic in REPLAYED if self.steps[topic.name]]

    @property
    def absent(self) -> list[str]:
        """Names of the topics of a rig, those of optional roles aside, that have no message of this run."""
        return [topic.name for topic in REPLAYED if not writer_of(topic).optional and not self.steps[topic.name]]

    @property
    def end(self) -> int | None:
        """Step before which the run is over; None: its end is not there."""
        return next(map(int, self.ends[STROBE_READING.name].steps()), None)

    @property
    def last(self) -> int:
        """The last step; -1 where there is none.

        Of a run without its end it is the last that stands on all topics: some of them may run ahead.
        """
        if self.end is not None:
            return self.end - 1
        on_all = [self.steps[topic].steps() for topic in self.present]
        return next(map(int, reduce(np.intersect1d, on_all)[::-1]), -1) if on_all else -1

    def ids(self, topics: Iterable[str]) -> Iterator[StepId]:
        """Yield the numbers of the steps that have a message on some of the topics, in order; then of the end."""
        names, last, end = list(topics), self.last, self.end
        steps = all_steps(self.steps[topic] for topic in names)
        yield from (StepId(self.number, int(step)) for step in steps[steps <= last])
        if end is not None and any(self.ends[topic].get(end) is not None for topic in names):
            yield StepId(self.number, end, end=True)

    def missing(self, topic: str) -> tuple[tuple[int, int], ...]:
        """Return first and last of each stretch of steps that a topic lacks, up to the last step of the run."""
        steps, last = self.steps[topic].steps(), self.last
        edges = np.concatenate(([-1], steps[steps <= last], [last + 1]))
        before = np.flatnonzero(np.diff(edges) > 1)
        return tuple(zip((edges[before] + 1).tolist(), (edges[before + 1] - 1).tolist(), strict=True))

    def defects(self) -> list[str]:
        """Return what is missing or stands twice, a sentence each."""
        found = []
        if self.repeated:
            found.append(f'{self.repeated} messages of run {self.number} stand there twice, and count once')
        by_steps: dict[tuple[tuple[int, int], ...], list[str]] = {}
        for topic in self.present:
            if missing := self.missing(topic):
                by_steps.setdefault(missing, []).append(topic)
        if self.present and (absent := self.absent):
            found.append(f'run {self.number} has no message on {", ".join(absent)}')
        for missing, topics in by_steps.items():
            where = '' if len(topics) == len(self.present) else f' on {", ".join(topics)}'
            found.append(f'{steps_text(missing)} of run {self.number}: missing{where}')
        if self.end is None:
            found.append(
                f'run {self.number} has no end: it was interrupted, or what came after step {max(self.last, 0)} is lost'
            )
        return found

    @property
    def messages(self) -> int:
        """How many there are."""
        return sum(len(found) for by_topic in (self.steps, self.ends) for found in by_topic.values())


def all_steps(maps: Iterable[StepMap]) -> NDArray[np.int64]:
    """Return the steps that have a message in one of several, in order."""
    return np.unique(np.concatenate([np.zeros(0, np.int64), *(each.steps() for each in maps)]))


def in_ranges(numbers: Iterable[int]) -> list[tuple[int, int]]:
    """Return first and last of each stretch of whole numbers that follow one another; they must grow."""
    ranges: list[tuple[int, int]] = []
    for number in numbers:
        if ranges and number == ranges[-1][1] + 1:
            ranges[-1] = (ranges[-1][0], number)
        else:
            ranges.append((number, number))
    return ranges


def steps_text(ranges: Iterable[tuple[int, int]]) -> str:
    """Return stretches of steps as a person writes them: `step 3, steps 7 to 9`."""
    listed = list(ranges)
    texts = [f'step {first}' if first == last else f'steps {first} to {last}' for first, last in listed[:3]]
    if len(listed) > 3:
        texts.append(f'and {sum(last - first + 1 for first, last in listed[3:])} more')
    return ', '.join(texts)
