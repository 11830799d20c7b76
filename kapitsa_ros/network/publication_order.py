"""Telling the messages of a topic's one writer from what others say there.

Who wrote a message, it does not say. But DDS counts the publications of each writer, and the writer of a numbered topic
makes one a step, from the first on: publication and step go on together. What does not fit is not its; and where two
messages claim the same place, one of them may have been believed.
"""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.network.step_id import StepId

_REMEMBERED = 2
"""Runs of which it is known at which publication they began."""


class Provenance(Enum):
    """What a message is."""

    OWN = 'of the writer, as far as can be told'
    FOREIGN = 'of somebody else: it has changed nothing'
    CONTESTED = 'in a place that another message has taken: one of the two is somebody else'


def counts_from_the_first(publication: int | None, step_id: StepId) -> bool:
    """Whether a publication has the number that it has where each step of the run was published once, and no more."""
    return publication is None or publication == step_id.step + 1


class PublicationOrder:
    """The order of a topic's publications, as one reader hears them.

    Parameters
    ----------
    is_alone
        Whether the graph shows one writer of the topic at this moment.

    """

    def __init__(self, is_alone: Callable[[], bool]) -> None:
        self._is_alone = is_alone
        self._last: tuple[int, StepId] | None = None
        self._before: StepId | None = None
        self._began: dict[int, int] = {}
        self._skipped: list[range] = []
        self._doubtful: int | None = None
        """The first publication that may be another writer's: before it all are the writer's own."""

    @property
    def knows_another(self) -> bool:
        """Whether there was news of another writer."""
        return self._doubtful is not None

    def note_another(self) -> None:
        """Note that there is another writer: one of its messages may have come before the news of it, as the last."""
        if not self.knows_another:
            self._doubtful = self._last[0] if self._last else 0

    def note_unreadable(self, publication: int | None) -> None:
        """Note a publication that cannot be read: it may tell of another writer before its match event does."""
        if publication is not None and self._last is not None and publication <= self._last[0]:
            self.note_another()

    def classify(self, publication: int | None, step_id: StepId) -> Provenance:
        """Return what a message is, and remember it if it goes on where the last one was.

        Parameters
        ----------
        publication
            Its number among those of its writer; None where the middleware counts none.
        step_id
            Its number in the graph.

        """
        if publication is None:
            return Provenance.OWN
        if self._last is None:
            return self._classify_first(publication, step_id)
        last, last_step = self._last
        if publication <= last:
            self.note_another()  # each writer's come in order, and once; the match event may be late
            return Provenance.CONTESTED if self._is_contested(publication, step_id) else Provenance.FOREIGN
        if publication > last + 1 and not self._is_alone():
            return Provenance.CONTESTED if self._before is None and step_id == last_step else Provenance.FOREIGN
        if step_id.follows(last_step) or (step_id.step == 0 and step_id.run > last_step.run):
            # What has been skipped was no numbered message, or no step of its own.
            self._skipped = [*self._skipped[-8:], range(last + 1, publication)]
            self._take(publication, step_id)
        return Provenance.OWN

    def _classify_first(self, publication: int, step_id: StepId) -> Provenance:
        if step_id.run == 1 and not counts_from_the_first(publication, step_id):
            return Provenance.FOREIGN
        if self._is_alone():
            self._take(publication, step_id)
            return Provenance.OWN
        return Provenance.CONTESTED if step_id.step == 0 else Provenance.FOREIGN

    def _is_contested(self, publication: int, step_id: StepId) -> bool:
        first_of_all = self._before is None and self._last is not None and step_id == self._last[1]
        began = self._began.get(step_id.run)
        same_place = began is not None and publication == began + step_id.step and self._is_doubtful(publication)
        return first_of_all or same_place or any(publication in skipped for skipped in self._skipped)

    def _is_doubtful(self, publication: int) -> bool:
        return self._doubtful is not None and publication >= self._doubtful

    def _take(self, publication: int, step_id: StepId) -> None:
        self._before = self._last[1] if self._last else None
        self._last = (publication, step_id)
        if step_id.step == 0 or step_id.run not in self._began:
            self._began[step_id.run] = publication - step_id.step
        while len(self._began) > _REMEMBERED:
            del self._began[next(iter(self._began))]
