"""The thread that uses the rig: carries out orders, and passes on messages of the graph."""

from __future__ import annotations

import threading
import time
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Protocol

from kapitsa_ros.errors import said_of
from kapitsa_ros.network.registry import COMMAND, PIVOT, RECORDED
from kapitsa_ros.operator.errors import RequestError
from kapitsa_ros.rig.errors import RigError

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.message import Message
    from kapitsa_ros.rig.harness import Rig
    from kapitsa_ros.ros.rig_client import News

    Order = Callable[[Rig], None]

_TOPICS = tuple(topic.name for topic in RECORDED if topic is not COMMAND)
"""That a person sees something of: what was commanded they know."""
_AWAITED = tuple(name for name in _TOPICS if name != PIVOT.name)
"""That end a wait: the pivot of a step comes before its pendulum, and where not, it is taken with what comes next."""
LISTEN = 1.0
"""Seconds for which news is waited for; an order ends the wait."""
GRACE = 3.0
"""Seconds given to an order under way when all is to end."""


class Listener(Protocol):
    """Receives what happens; called from the worker's thread."""

    def receive(self, news: list[News], wall: float) -> None:
        """Take messages of the graph, and when they came (wall clock, s)."""

    def receive_refusal(self, why: Message) -> None:
        """Take why an order could not be carried out."""

    def receive_failure(self, error: RigError) -> None:
        """Take the error that ended the rig; nothing follows."""


class RigWorker:
    """Works a rig between `start` and `stop`.

    Parameters
    ----------
    rig
        Nobody else may use it meanwhile.
    listener
        Receives what happens.

    """

    def __init__(self, rig: Rig, listener: Listener) -> None:
        self._rig = rig
        self._listener = listener
        self._orders: SimpleQueue[tuple[Order, Callable[[], None] | None]] = SimpleQueue()
        self._ending = threading.Event()
        # A daemon: a rig that hangs must not keep the terminal.
        self._thread = threading.Thread(target=self._work, daemon=True)

    def start(self) -> None:
        """Begin to work."""
        self._thread.start()

    def stop(self) -> None:
        """Stop working; an order that hangs is left to itself."""
        self._ending.set()
        self._rig.wake()
        self._thread.join(GRACE)

    def order(self, order: Order, done: Callable[[], None] | None = None) -> None:
        """Have something done with the rig, after what was ordered before.

        `done` is called from the worker's thread once it has succeeded and the listener has what came until then.
        """
        self._orders.put((order, done))
        self._rig.wake()

    def _work(self) -> None:
        try:
            while not self._ending.is_set():
                self._carry_out()
                self._pass_on(LISTEN)
        except RigError as error:
            self._listener.receive_failure(error)
        except Exception as error:  # noqa: BLE001  # the person would look at a picture that stands still
            if not self._ending.is_set():  # then the rig may be taken away from an order that hangs
                self._listener.receive_failure(RigError('the bench lost its rig: {why!r}', why=error))

    def _pass_on(self, timeout: float) -> None:
        news = self._rig.news(timeout, _TOPICS, awaited=_AWAITED)
        if news:
            self._listener.receive(news, time.monotonic())

    def _carry_out(self) -> None:
        while not self._ending.is_set():
            try:
                order, done = self._orders.get_nowait()
            except Empty:
                return
            try:
                order(self._rig)
                if done is not None:
                    self._pass_on(0.0)
                    done()
            except (RigError, RequestError, TimeoutError) as error:  # of a death, the news tell
                self._listener.receive_refusal(said_of(error))
