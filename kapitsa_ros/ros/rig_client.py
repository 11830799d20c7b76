"""Client node for programs: publishes requests, calls the jigsaw's services, buffers the numbered topics."""

from __future__ import annotations

import contextlib
import os
import threading
from collections import deque
from typing import TYPE_CHECKING, Any, NamedTuple

from std_msgs.msg import Float64

from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import CLIENT, JIGSAW, REQUESTS, RESULT, TOPICS, WRITTEN, topic_named
from kapitsa_ros.ros.executor_tasks import guarded
from kapitsa_ros.ros.listener_node import ListenerNode
from kapitsa_ros.ros.numbered_subscription import NumberedSubscription
from kapitsa_ros.ros.time_control_client import RESET, TimeControlClient

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from types import TracebackType

    from rclpy.publisher import Publisher
    from rclpy.task import Future

    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.network.topic import Topic

UNREAD = 1000
"""Messages a topic keeps until they are read; then the oldest are forgotten."""
_VALUED = tuple(topic for topic in TOPICS if topic is not WRITTEN)
TOPIC_NAMES = tuple(topic.name for topic in _VALUED)
"""Topics that can be read."""


class _Message(NamedTuple):
    step_id: StepId
    raw: bytes


class News(NamedTuple):
    """What the graph said."""

    topic: str
    step_id: StepId
    value: Any
    """The message as the rooms without ROS have it."""


class RigClient(ListenerNode):
    """Listens to all numbered topics of a rig. A context: it listens while it lasts.

    Nothing here waits; `news` becomes readable whenever a message that is heeded or an answer came.

    Parameters
    ----------
    domain
        ROS domain of the rig.

    """

    def __init__(self, domain: int) -> None:
        self.seen: dict[str, StepId | None] = dict.fromkeys(topic.name for topic in TOPICS)
        """Number of the newest message by topic; silent ones and ends of runs count too."""
        self._missed: dict[str, StepId] = {}
        """Number of the first message of a topic that was heard, where it was not the first of all."""
        self._newest: dict[str, _Message] = {}
        self._unread: dict[str, deque[_Message]] = {name: deque(maxlen=UNREAD) for name in self.seen}
        self._lock = threading.Lock()
        self._woken = False
        """Whether `news` is readable: to say so again would be a system call a message."""
        self._heeded: frozenset[str] | None = None
        """Topics whose messages make `news` readable; None: all, their silence too."""
        super().__init__(CLIENT.name, domain)
        for topic in TOPICS:
            NumberedSubscription(self._node, topic, self._taker(topic), lambda _: None, self.fail)
        self._asks: dict[str, Publisher] = {name: self._node.create_publisher(Float64, name, 10) for name in REQUESTS}
        self._time = TimeControlClient(self._node, JIGSAW.name, RESET)
        self.news = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)  # last: only leaving the context closes it
        """File descriptor."""

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop listening."""
        try:
            super().__exit__(kind, error, trace)
        finally:
            os.close(self.news)

    def heed(self, topics: Iterable[str] | None) -> None:
        """Have `news` become readable by what topics say, and not by their silence; None: by any message."""
        self._heeded = None if topics is None else frozenset(topics)

    def clear_news(self) -> None:
        """Make `news` unreadable until something comes."""
        with contextlib.suppress(BlockingIOError):
            os.eventfd_read(self.news)
        self._woken = False  # last: what comes before is found by whoever looks after this call

    def take(self, topic: str, predicate: Callable[[Any], bool] | None) -> Any:
        """Return the first unread message that fits, as a plain type, or None; those before it count as read."""
        unread = self._unread[topic]
        while unread:
            with self._lock:
                message = unread.popleft()
            try:
                value = topic_named(topic).decode(message.raw)
            except WireError:
                continue  # somebody else's; the nodes of the rig say so
            if predicate is None or predicate(value):
                return value
        return None

    def has_unread(self, topics: Sequence[str]) -> bool:
        """Whether there are unread messages of topics."""
        return any(self._unread[name] for name in topics)

    def take_all(self, topics: Sequence[str] = TOPIC_NAMES) -> list[News]:
        """Return the unread messages of topics, in the order of their steps."""
        with self._lock:
            taken = [(name, message) for name in topics for message in self._unread[name]]
            for name in topics:
                self._unread[name].clear()
        news = []
        for name, message in taken:
            with contextlib.suppress(WireError):  # somebody else's; the nodes of the rig say so
                news.append(News(name, message.step_id, topic_named(name).decode(message.raw)))
        return sorted(news, key=lambda item: (item.step_id.run, item.step_id.step))

    def latest(self, topic: str) -> Any:
        """Return the newest message that says something, as a plain type; None where there is none, or a stranger's."""
        message = self._newest.get(topic)
        if message is None:
            return None
        try:
            return topic_named(topic).decode(message.raw)
        except WireError:
            return None  # somebody else's; the nodes of the rig say so

    def forget_before(self, run: int) -> None:
        """Drop what was said in earlier runs; not their results, which come when a run is over."""
        with self._lock:
            for name, unread in self._unread.items():
                if name == RESULT.name:
                    continue
                kept = [message for message in unread if message.step_id.run >= run]
                unread.clear()
                unread.extend(kept)
                if name in self._newest and self._newest[name].step_id.run < run:
                    del self._newest[name]

    def told_missed(self, topics: Iterable[str]) -> str:
        """Return in a sentence since when topics are heard, of which the first messages were not; it may be empty."""
        heard = [f'{name} only from {self._missed[name]} on' for name in topics if name in self._missed]
        if not heard:
            return ''
        return f'this program heard {", ".join(heard)}: name {CLIENT.name}, too, in the parameter expect of that node'

    def is_heard(self, topic: str) -> bool:
        """Whether somebody takes requests on a topic."""
        return self._asks[topic].get_subscription_count() > 0

    def is_served(self) -> bool:
        """Whether the node that owns time is there for calls."""
        return self._time.is_served()

    def ask(self, topic: str, value: float) -> None:
        """Publish a request."""
        self._asks[topic].publish(Float64(data=value))

    def call(self, service: str) -> Future:
        """Call a service of the node that owns time; the answer is a Trigger.Response."""
        return self._telling(self._time.call(service))

    def set_parameters(self, **values: float) -> Future:
        """Set parameters of the node that owns time; the answer is a SetParameters.Response."""
        return self._telling(self._time.set_parameters(**values))

    def _telling(self, future: Future) -> Future:
        future.add_done_callback(guarded(lambda _: self.wake(), self.fail))
        return future

    def wake(self) -> None:
        """Make `news` readable."""
        if not self._woken:
            self._woken = True
            os.eventfd_write(self.news, 1)

    def _taker(self, topic: Topic[Any]) -> Callable[[StepId, bytes], None]:
        unread = self._unread[topic.name]

        def take(step_id: StepId, raw: bytes) -> None:
            message, is_silence = _Message(step_id, raw), topic.codec.is_silence(raw)
            with self._lock:
                if self.seen[topic.name] is None and step_id.step > 0:
                    self._missed[topic.name] = step_id
                if not is_silence:
                    self._newest[topic.name] = message
                    unread.append(message)
                self.seen[topic.name] = message.step_id
            if self._heeded is None or (topic.name in self._heeded and not is_silence):
                self.wake()

        return take
