"""A subscription to a numbered topic, which takes what its one writer says and nothing else."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from rclpy.event_handler import SubscriptionEventCallbacks

from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.errors import SequenceError, WireError
from kapitsa_ros.network.publication_order import Provenance, PublicationOrder, counts_from_the_first
from kapitsa_ros.network.step_id import ends_session
from kapitsa_ros.ros.errors import NodeError
from kapitsa_ros.ros.executor_tasks import guarded
from kapitsa_ros.ros.node_names import wait_for_names
from kapitsa_ros.ros.process_node import ASKS_ITSELF
from kapitsa_ros.ros.qos import STREAM, message_class
from kapitsa_ros.ros.writer_watch import WriterWatch

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.network.topic import Topic

_WITH_INFO = inspect.signature(lambda message, info: (message, info))
"""Of a callback that rclpy gives what it knows of a message."""


class NumberedSubscription:
    """Subscribes a node to a numbered topic.

    Parameters
    ----------
    node
        Who reads.
    topic
        What.
    take
        Called with the number and the bytes of each message of the topic's writer.
    refuse
        Called with why a message was not used.
    fail
        Called with what `take` raises, and with a NodeError where two have said what one alone may say, and it is not
        known whom to believe.
    met
        Called when a writer has come or left.

    """

    def __init__(
        self,
        node: Node,
        topic: Topic[Any],
        take: Callable[[StepId, bytes], None],
        refuse: Callable[[str], None],
        fail: Callable[[Exception], None],
        *,
        met: Callable[[], None] = lambda: None,
    ) -> None:
        self._node, self._topic, self._take, self._refuse = node, topic, take, refuse
        self._met = met
        self._watch = WriterWatch(node, topic)
        self._order = PublicationOrder(self._watch.is_alone)
        self._is_over = False
        """Whether the writer has said that no run follows: it may leave."""

        def receive(message: Any, info: Any = None) -> None:
            # The events executor of rclpy 7.1 gives both as one argument.
            raw, info = message if info is None else (message, info)
            try:
                self._receive(raw, info.get('publication_sequence_number'))
            except Exception as error:  # noqa: BLE001  # thrown through the executor it would lose its type
                fail(error)

        receive.__signature__ = _WITH_INFO  # type: ignore[attr-defined]
        setattr(receive, ASKS_ITSELF, True)
        events = SubscriptionEventCallbacks(matched=guarded(self._note_match, fail))
        kind = message_class(topic.type)
        node.create_subscription(kind, topic.name, receive, STREAM, raw=True, event_callbacks=events)

    @property
    def topic(self) -> Topic[Any]:
        """What is read."""
        return self._topic

    @property
    def has_had_one_writer(self) -> bool:
        """Whether its own writer was the only one that was ever there."""
        return self._watch.is_known and not self._order.knows_another

    def strangers(self) -> list[str]:
        """Return the names of nodes that write the topic besides the one whose topic it is."""
        return self._watch.strangers()

    def is_lost(self) -> bool:
        """Whether the topic's writer is not there, and has not said that no run follows."""
        self._watch.refresh()
        return not self._is_over and self._watch.is_gone

    def _note_match(self, event: Any) -> None:
        self._watch.note_match(event)
        if not self._watch.has_been_alone:
            self._order.note_another()
        self._met()
        self._refuse_another()

    def _refuse_another(self) -> None:
        fault = None if self._is_over else self._watch.fault()
        if fault is not None:
            raise NodeError(f'{self._topic.name} {fault}')

    def _is_of_nobody(self, publication: int | None, step_id: StepId) -> bool:
        """Whether nobody whose topic it is can have said what came; asked until all is clear."""
        self._watch.refresh()
        self._refuse_another()
        if self._watch.is_known:
            return False
        return not self._watch.know(counts_from_the_first=counts_from_the_first(publication, step_id))

    def _receive(self, raw: bytes, publication: int | None) -> None:
        name = self._topic.name
        try:
            step_id = read_step_id(raw)
        except WireError as error:
            self._order.note_unreadable(publication)
            strangers = ', '.join(self.strangers())
            self._refuse(f'{name}: {error}{f" ({strangers} writes there too)" if strangers else ""}')
            return
        if not self._watch.is_steady and self._is_of_nobody(publication, step_id):
            others = ', '.join(self.strangers()) or 'a node that has left'
            self._refuse(f'{name}: {step_id} comes from {others}, whose topic it is not')
            return
        provenance = self._order.classify(publication, step_id)
        if provenance is Provenance.OWN:
            self._take_own(step_id, raw)
            return
        if provenance is Provenance.CONTESTED:
            others = ', '.join(wait_for_names(self.strangers)) or 'a node that has left'
            raise NodeError(f'{name} has a second writer, {others}: which {step_id} is the right one cannot be told')
        others = ', '.join(self.strangers()) or 'a node that has left'
        self._refuse(f'{name}: {step_id}, publication {publication}, comes from a second writer, {others}')

    def _take_own(self, step_id: StepId, raw: bytes) -> None:
        """Take what is the writer's, as far as can be told; a second writer may have hit upon its next publication."""
        if step_id.end and ends_session(step_id):
            self._is_over = True
        try:
            self._take(step_id, raw)
        except SequenceError as error:
            others = ', '.join(wait_for_names(self.strangers))
            if not others:
                raise
            raise NodeError(f'{error}; it has a second writer, {others}') from error
