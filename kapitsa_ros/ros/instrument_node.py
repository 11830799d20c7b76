"""An instrument in the graph: watches one motion, and says now and then what it reads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from kapitsa_ros.instruments.random_streams import random_stream
from kapitsa_ros.network.cdr import stamp_of
from kapitsa_ros.network.messages import decode_samples
from kapitsa_ros.ros.parameters import declare_seed
from kapitsa_ros.ros.step_node import StepNode, seconds_of_run

if TYPE_CHECKING:
    from numpy.random import Generator

    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.network.topics import Topic
    from kapitsa_ros.physics.sampled_motion import SampledMotion


class Instrument(Protocol):
    """What the instruments room offers."""

    def observe(self, start: float, motion: SampledMotion, /) -> Any:
        """Watch one step; return a reading or None."""


class InstrumentNode(StepNode):
    """Base of strobe and stopwatch.

    Parameters
    ----------
    name
        The role, which is also the name of its stream of chance.
    watches, says
        The topic it reads and the one it writes.

    """

    def __init__(self, name: str, *, watches: Topic, says: Topic) -> None:
        super().__init__(name, reads=(watches,), writes=(says,))
        self.seed = declare_seed(self)
        self._watches, self._says = watches, says
        self._observer: Instrument

    def observer(self, chance: Generator) -> Instrument:
        """Return the instrument and its person, as they begin a run."""
        raise NotImplementedError

    def encode(self, stamp_ns: int, step_id: StepId, reading: Any) -> bytes:
        """Encode a reading or silence."""
        raise NotImplementedError

    def work(self, step_id: StepId, messages: dict[str, bytes]) -> None:
        """Watch one step."""
        raw = messages[self._watches.name]
        if step_id.step == 0:
            self._observer = self.observer(random_stream(self.seed, self.get_name(), step_id.run))
        stamp = stamp_of(raw)
        reading = self._observer.observe(seconds_of_run(stamp, step_id), decode_samples(raw))
        self.emit(self._says, self.encode(stamp, step_id, reading))
