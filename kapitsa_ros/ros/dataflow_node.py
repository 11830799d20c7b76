"""A node of the dataflow network: emits step n once it has its inputs for step n."""

from __future__ import annotations

import math
import time
from contextlib import ExitStack, suppress
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import Log
from rclpy._rclpy_pybind11 import RCLError  # the refusal of a full writer has no public type
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.executors import ExternalShutdownException

from kapitsa_ros.errors import shorten
from kapitsa_ros.network.cdr import aligned, stamp_of
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import (
    KNOWN_NAMES,
    PLAYER,
    REPLAY_NAMES,
    REQUIRED_NAMES,
    ROLE_NAMES,
    writer_of,
    writers_of,
)
from kapitsa_ros.network.settings import SETTINGS_TYPE, settings_topic
from kapitsa_ros.network.step_clock import DAY
from kapitsa_ros.network.typestore import load_type
from kapitsa_ros.ros.diagnostics import failure_message, health_message, reporter_name
from kapitsa_ros.ros.errors import NodeError, SettingError
from kapitsa_ros.ros.executor_tasks import guarded
from kapitsa_ros.ros.node_logger import NodeLogger
from kapitsa_ros.ros.numbered_subscription import NumberedSubscription
from kapitsa_ros.ros.parameters import declare
from kapitsa_ros.ros.peer_discovery import PeerDiscovery
from kapitsa_ros.ros.process_node import ProcessNode
from kapitsa_ros.ros.qos import LATCHED, STREAM, message_class
from kapitsa_ros.ros.throttle import Throttle
from kapitsa_ros.ros.topic_lock import topic_lock

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.publisher import Publisher

    from kapitsa_ros.network.role import Role
    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.network.topic import Topic

T = TypeVar('T')

IDLE = 1.0
"""Seconds between two looks around when only messages give work."""
LOOK_PERIOD = 0.05
"""Seconds between two looks at the graph while peers are missing."""
_LOOK_PERIOD_AFTER_MATCH = 0.01
_AFTER_MATCH = 0.3
"""Seconds for which that is the period after a match event: the graph shows a moment later whose the matched end is."""
HEALTH_PERIOD = 1.0
"""Seconds of wall time between two reports of a node's health."""
STRANGER_PERIOD = 5.0
"""Seconds of wall time between two looks at who else writes: what they write is refused at once."""
GRACE = 3.0
"""Seconds for which messages are waited for to be taken before it is said."""
LEASE = 25.0
"""Seconds after which DDS has given up a reader that is silent; who is still not served then never will be."""
PARTING = Duration(nanoseconds=200_000_000)
"""How long words are waited for that nobody depends on."""


class DataflowNode(ProcessNode):
    """Base of the eight nodes: numbered topics in and out, and peers to wait for.

    Parameters
    ----------
    role
        Its name and its numbered topics; those that an unexpected peer would write are left out.

    """

    def __init__(self, role: Role) -> None:
        self._locks = ExitStack()  # before the rest: a node whose constructor fails is destroyed, too
        super().__init__(role)
        names = REPLAY_NAMES if role is PLAYER else REQUIRED_NAMES
        expect = declare(self, 'expect', list(names), 'roles of the graph: no step is emitted before they are matched')
        self.expected = frozenset(expect or ())
        unknown = self.expected - KNOWN_NAMES
        if unknown or not self.expected:
            raise SettingError(
                f'parameter expect: {sorted(unknown) or "nothing"}: name roles of {", ".join(ROLE_NAMES)}'
            )
        self._failure: Exception | None = None
        self._held_up = 0
        self._stamp_ns = DAY
        """Simulated time of what was emitted last; the first run begins with its day."""
        self._health = Throttle(HEALTH_PERIOD)
        self._stranger_look = Throttle(STRANGER_PERIOD)
        self.diagnostics = self.create_publisher(DiagnosticArray, '/diagnostics', 10)
        self._rosout = self.create_publisher(Log, '/rosout', LATCHED)
        self.reads = tuple(topic for topic in role.reads if writers_of(topic) & self.expected)
        if role.reads and not self.reads:
            raise SettingError(f'parameter expect: nobody there would write {role.reads[0].name}')
        self.writes = role.writes
        self._last_match = time.monotonic()
        """When the last match event came."""
        events = PublisherEventCallbacks(matched=guarded(lambda _: self._note_match(), self.keep_failure))
        self._out = {
            topic.name: self.create_publisher(message_class(topic.type), topic.name, STREAM, event_callbacks=events)
            for topic in self.writes
        }
        self._inputs = [
            NumberedSubscription(
                self, topic, self._taker(topic.name), self.refuse, self.keep_failure, met=self._note_writers
            )
            for topic in self.reads
        ]
        self._known_strangers: set[str] = set()
        self._has_met = True
        """Whether a writer has come or left since this node has looked for another rig."""
        self._heard_since = False
        """Whether a message came since the last look at the graph."""
        for topic in (*self.reads, *self.writes):
            load_type(topic.type)
        self._peers = PeerDiscovery(self, self.writes, self.reads, self.expected)

    # What a role adds.

    def accept(self, topic: str, step_id: StepId, raw: bytes) -> bool:
        """Take a message in; return False if its step was there before."""
        raise NotImplementedError

    def advance(self) -> float:
        """Do all steps whose inputs are there; return the seconds until the next call is due without a message."""
        raise NotImplementedError

    def pending(self) -> float:
        """Return the seconds until something is due besides steps."""
        return math.inf

    # What every role has.

    def open(self) -> None:
        """Lock its topics: who writes them on this machine already may be one that DDS has not found yet.

        Raises
        ------
        NodeError
            Another process writes one.

        """
        for name in self._out:
            self._locks.enter_context(topic_lock(self.resolve_topic_name(name), self.context.get_domain_id()))

    def destroy_node(self) -> None:
        """Unlock its topics, once nobody can hear it any more."""
        super().destroy_node()  # type: ignore[no-untyped-call]
        self._locks.close()

    def get_logger(self) -> NodeLogger:
        """Return the logger."""
        return self._node_logger

    @cached_property
    def _node_logger(self) -> NodeLogger:
        return NodeLogger(super().get_logger().name)  # type: ignore[no-untyped-call]

    def latch_settings(self, text: str) -> None:
        """Publish this node's settings for whoever records or analyses its runs, now or later."""
        settings = message_class(SETTINGS_TYPE)
        self.create_publisher(settings, settings_topic(self.role.name), LATCHED).publish(settings(data=text))

    def emit(self, topic: Topic[T], step_id: StepId, stamp_ns: int, value: T) -> None:
        """Publish a value as the message of a step."""
        self.emit_raw(topic, topic.encode(stamp_ns, step_id, value))

    def emit_raw(self, topic: Topic[Any], raw: bytes) -> None:
        """Publish one message; a reader that is behind slows the writer, it does not break it.

        Raises
        ------
        NodeError
            A reader that is not of the rig takes nothing, and DDS has not given it up.

        """
        publisher = self._out[topic.name]
        raw += bytes(aligned(len(raw), 4))  # as DDS pads it on its way, but not to a reader in the same process
        self._stamp_ns = stamp_of(raw)
        full_since = None
        while True:
            try:
                publisher.publish(raw)
            except RCLError:
                if not self.context.ok():
                    raise ExternalShutdownException from None
                if full_since is None:
                    full_since = time.monotonic()
                    self._say_held_up(topic.name, 'is full')
                elif time.monotonic() - full_since > LEASE:
                    self._refuse_outsiders(topic.name)
                time.sleep(0.01)
            else:
                return

    def emit_silence(self, topic: Topic[Any], step_id: StepId, stamp_ns: int) -> None:
        """Publish a message that holds nothing but its number."""
        self.emit_raw(topic, topic.codec.encode_silence(stamp_ns, step_id))

    def finish(self) -> None:
        """Leave once the last messages have been taken by their readers."""
        for publisher in self._out.values():
            self.wait_until_taken(publisher)
        self.diagnostics.wait_for_all_acked(PARTING)
        self.finished = True
        self.wake()

    def keep_failure(self, error: Exception) -> None:
        """Fail soon: thrown through the executor an exception would lose its type."""
        self._failure = self._failure or error
        self.be_due()

    def wait_until_taken(self, publisher: Publisher) -> None:
        """Wait for the readers of a topic to take all that was published, as long as DDS waits for them."""
        begin = time.monotonic()
        said = False
        while self.context.ok() and not publisher.wait_for_all_acked(PARTING):
            waited = time.monotonic() - begin
            if waited > GRACE and not said:
                self._say_held_up(publisher.topic_name, 'has not been taken')
                said = True
            if waited > LEASE:
                return

    def fail(self, error: Exception) -> None:
        """Tell whoever watches `/diagnostics` or /rosout why this node ends; stderr has its own line."""
        why = shorten(str(error))
        with suppress(RCLError):  # nobody can be told once a signal has shut the context
            self.diagnostics.publish(failure_message(reporter_name(self), self._stamp_ns, why))
            now = self.get_clock().now().to_msg()
            self._rosout.publish(Log(stamp=now, level=Log.FATAL, name=self.get_logger().name, msg=why))
            for publisher in (self.diagnostics, self._rosout):
                publisher.wait_for_all_acked(PARTING)

    def poll(self) -> float:
        """Do what is due; return the seconds until the next call."""
        if self._failure is not None:
            raise self._failure
        if self._health.due():
            report = health_message(reporter_name(self), self._stamp_ns, self.refused, self._held_up)
            self.diagnostics.publish(report)
            if self._peers.matched:
                if self._stranger_look.due():
                    self._name_strangers()
                lost = {writer_of(source.topic).name for source in self._inputs if source.is_lost()}
                self._peers.refuse_lost(lost, heard=self._heard_since)
                self._heard_since = False
        if not self._peers.ready():
            return _LOOK_PERIOD_AFTER_MATCH if time.monotonic() < self._last_match + _AFTER_MATCH else LOOK_PERIOD
        if self._has_met:
            self._has_met = not self._peers.give_way()
        wait = self.advance()
        return min(wait, LOOK_PERIOD) if self._has_met else wait

    def _note_writers(self) -> None:
        self._has_met = True
        self._note_match()

    def _note_match(self) -> None:
        self._last_match = time.monotonic()
        self.be_due()

    def _say_held_up(self, topic: str, how: str) -> None:
        readers, outsiders = ', '.join(self._peers.readers(topic)), ', '.join(self._outsiders(topic))
        which = f', of which {outsiders} is not of this rig' if outsiders else ''
        self.get_logger().warning(f'{topic} {how}: waiting for a reader that has stopped ({readers}){which}')
        self._held_up += 1

    def _outsiders(self, topic: str) -> list[str]:
        return [name for name in self._peers.readers(topic) if name not in self.expected]

    def _refuse_outsiders(self, topic: str) -> None:
        outsiders = self._outsiders(topic)
        if outsiders:
            raise NodeError(
                f'{topic} has been full for {LEASE:g} s: {", ".join(outsiders)} reads it, is not of this rig, and '
                'has to take what it reads or leave'
            )

    def _name_strangers(self) -> None:
        for name in {name for source in self._inputs for name in source.strangers()} - self._known_strangers:
            self._known_strangers.add(name)
            self.get_logger().warning(
                f'{name} writes what is not its to write: it is refused, or ends the run where it cannot be told apart'
            )

    def _taker(self, name: str) -> Callable[[StepId, bytes], None]:
        def take(step_id: StepId, raw: bytes) -> None:
            self._heard_since = True
            if self.finished:  # what others of its process still say is not for it
                return
            try:
                fresh = self.accept(name, step_id, raw)
            except WireError as error:
                self.refuse(f'{name}: {error}')
                return
            if not fresh:
                self.refuse(f'a step of {name} that was there before')
            elif self._peers.matched:
                wait = min(self.advance(), self.pending())
                if (now := time.monotonic()) >= self.due:  # the executor looks at its time-out when no message is left
                    self.wake()
                else:
                    self.be_due(now + wait)

        return take
