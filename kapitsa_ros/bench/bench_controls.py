"""What a person does at the bench, whatever it is shown on."""

from __future__ import annotations

import time
from contextlib import suppress
from typing import TYPE_CHECKING

from kapitsa_ros.bench.bench_state import FASTEST
from kapitsa_ros.bench.rig_worker import RigWorker
from kapitsa_ros.rig.errors import RigError

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.bench.bench_state import BenchState
    from kapitsa_ros.bench.rig_worker import Order
    from kapitsa_ros.message import Message
    from kapitsa_ros.rig.harness import Rig
    from kapitsa_ros.ros.rig_client import News

SLOWEST_PACE, FASTEST_PACE = 1 / 8, 32.0
PATIENCE = 5.0
"""Wall seconds given to the run to end."""


class BenchControls:
    """Turns what a person does into orders for a rig, and keeps the state of the bench.

    Parameters
    ----------
    rig
        Started with the protocol `manual`; nobody else may use it between `start` and `stop`.
    state
        Of this rig's bench.
    post
        Has a call made in the thread in which the state lives; called from any thread.
    on_failure
        Called there with the error of a rig that died; nothing follows.
    on_news
        Called there with what the state has just received.

    """

    def __init__(
        self,
        rig: Rig,
        state: BenchState,
        post: Callable[[Callable[[], None]], None],
        on_failure: Callable[[RigError], None],
        on_news: Callable[[list[News]], object] = lambda _: None,
    ) -> None:
        self._state = state
        self._post = post
        self._on_failure, self._on_news = on_failure, on_news
        self._worker = RigWorker(rig, self)
        self._wants_paused: bool | None = None
        """By the last order that the rig has not answered yet."""

    def start(self) -> None:
        """Begin to use the rig."""
        self._worker.start()

    def stop(self) -> None:
        """Leave the rig; an order that hangs is left to itself."""
        self._worker.stop()

    def now(self) -> float:
        """Return the simulated time, s of the run."""
        return self._state.clock.now(time.monotonic())

    def set_speed(self, rpm: float) -> None:
        """Ask for another speed, RPM.

        Raises
        ------
        RequestError
            The jigsaw cannot turn so.

        """
        before = self._state.speed
        self._state.set_speed(rpm)
        if not self._order(lambda rig: rig.request_speed(rpm)):
            self._state.set_speed(before)

    def change_speed(self, change: float) -> None:
        """Ask for a speed that differs by some RPM, as far as the jigsaw goes."""
        self.set_speed(min(max(self._state.speed + change, 0.0), float(FASTEST)))

    def release(self) -> None:
        """Have the pendulum caught and let go."""
        angle = self._state.release
        self._order(lambda rig: rig.release(angle), lambda: self._state.note_release(angle))

    def toggle_pause(self) -> None:
        """Stop time, or let it run."""
        paused = not (self._state.paused if self._wants_paused is None else self._wants_paused)

        def then() -> None:
            if self._wants_paused == paused:  # no later order waits
                self._wants_paused = None
            self._state.set_paused(paused=paused)

        if self._order((lambda rig: rig.pause()) if paused else (lambda rig: rig.resume()), then):
            self._wants_paused = paused

    def step(self) -> None:
        """Make one step of a paused rig."""
        self._order(lambda rig: rig.step())

    def set_pace(self, rate: float) -> None:
        """Change the pace of time, simulated over wall seconds, as far as it may be changed."""
        rate = min(max(rate, SLOWEST_PACE), FASTEST_PACE)

        def then() -> None:
            self._state.clock.rate = rate

        self._order(lambda rig: rig.set_rate(rate), then)

    def change_pace(self, factor: float) -> None:
        """Change the pace of time by a factor."""
        self.set_pace(factor * (self._state.clock.rate or 2 * FASTEST_PACE))

    def begin_run(self) -> None:
        """End the run and begin the next."""
        if self._order(lambda rig: rig.reset()):
            self._state.set_speed(0.0)
            if self._state.paused:
                self._state.notify('the next run begins when time goes on')

    def end_run(self, then: Callable[[], None]) -> None:
        """End the run, so that its bag is complete, and go on with `then` whether that succeeded or not."""
        paused = self._state.paused

        def finish(rig: Rig) -> None:
            try:
                if not paused:
                    with suppress(RigError):  # somebody else may have paused it
                        rig.pause()
                rig.reset()
            finally:
                self._post(then)

        self._worker.order(finish)

    def receive(self, news: list[News], wall: float) -> None:
        """Hand messages of the graph to the state; called from the rig's thread."""

        def take() -> None:
            self._state.receive(news, wall)
            self._on_news(news)

        self._post(take)

    def receive_refusal(self, why: Message) -> None:
        """Tell why an order was refused; called from the rig's thread."""

        def take() -> None:
            self._wants_paused = None
            self._state.messages.append(why)

        self._post(take)

    def receive_failure(self, error: RigError) -> None:
        """Tell of a rig that died; called from the rig's thread."""
        self._post(lambda: self._on_failure(error))

    def _order(self, act: Order, then: Callable[[], None] | None = None) -> bool:
        """Order something from the rig's thread, and `then` in that of the state; return False before the first run."""
        if not self._state.run:
            self._state.notify('the nodes are starting: a moment')
            return False
        self._worker.order(act, None if then is None else lambda: self._post(then))
        return True
