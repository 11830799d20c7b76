"""The messages of one step, brought together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from kapitsa_ros.network.cdr import stamp_of
from kapitsa_ros.network.step_clock import seconds_of_run

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.network.topic import Topic

T = TypeVar('T')


@dataclass(frozen=True)
class Step:
    """What a node acts on: `step[topic]` is the value of a topic, decoded when it is looked at."""

    id: StepId
    raw: Mapping[str, bytes]
    """Messages by the name of their topic, the leading ones first."""

    @property
    def stamp_ns(self) -> int:
        """Stamp of the message of the first leading topic, ns."""
        return stamp_of(next(iter(self.raw.values())))

    @property
    def start(self) -> float:
        """The same in seconds of the run."""
        return seconds_of_run(self.stamp_ns, self.id)

    def __contains__(self, topic: Topic[T]) -> bool:
        """Whether the step has a message of a topic."""
        return topic.name in self.raw

    def __getitem__(self, topic: Topic[T]) -> T:
        """Return the value of a topic.

        Raises
        ------
        KeyError
            The step has no message of it.
        WireError
            Its message is none of this topic.

        """
        return topic.decode(self.raw[topic.name])
