"""An instrument in the graph: watches one motion, and says now and then what it reads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from kapitsa_ros.instruments.randomness import stream
from kapitsa_ros.nodes.parameters import declare_seed
from kapitsa_ros.nodes.stage import JoinedStage, seconds_of_run
from kapitsa_ros.recording.messages import decode_samples
from kapitsa_ros.recording.wire import stamp_of

if TYPE_CHECKING:
    from numpy.random import Generator

    from kapitsa_ros.physics.samples import Samples
    from kapitsa_ros.physics.steps import Tick
    from kapitsa_ros.recording.topics import Topic


class Observer(Protocol):
    """What the instruments room offers."""

    def observe(self, start: float, motion: Samples, /) -> Any:
        """Watch one step; return a reading or None."""


class InstrumentStage(JoinedStage):
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
        self._observer: Observer

    def observer(self, chance: Generator) -> Observer:
        """Return the instrument and its person, as they begin a run."""
        raise NotImplementedError

    def encode(self, stamp_ns: int, tick: Tick, reading: Any) -> bytes:
        """Encode a reading or silence."""
        raise NotImplementedError

    def work(self, tick: Tick, messages: dict[str, bytes]) -> None:
        """Watch one step."""
        raw = messages[self._watches.name]
        if tick.step == 0:
            self._observer = self.observer(stream(self.seed, self.get_name(), tick.run))
        stamp = stamp_of(raw)
        reading = self._observer.observe(seconds_of_run(stamp, tick), decode_samples(raw))
        self.emit(self._says, self.encode(stamp, tick, reading))
