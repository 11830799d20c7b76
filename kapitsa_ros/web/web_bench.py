"""The bench behind the pages: its rig, its state, and what pages are told of it."""

from __future__ import annotations

import asyncio
import secrets
import time
from collections import deque
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from kapitsa_ros.bench.bench_controls import PATIENCE, BenchControls
from kapitsa_ros.bench.bench_state import BenchState
from kapitsa_ros.errors import KapitsaError, said_of
from kapitsa_ros.network.registry import MOTION, PIVOT
from kapitsa_ros.operator.protocol import MANUAL
from kapitsa_ros.rig.harness import Rig
from kapitsa_ros.rig.preflight import make_writable
from kapitsa_ros.web.bench_report import report
from kapitsa_ros.web.book_fit import BookFit
from kapitsa_ros.web.errors import PageRequestError
from kapitsa_ros.web.motion_frame import encode_motion
from kapitsa_ros.web.page_clients import PageClients

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.bench.notebook import Notebook
    from kapitsa_ros.message import Message
    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.physics.sampled_motion import SampledMotion
    from kapitsa_ros.rig.errors import RigError
    from kapitsa_ros.ros.rig_client import News
    from kapitsa_ros.web.bench_setup import BenchSetup
    from kapitsa_ros.web.page_client import PageClient

_TOLD_EVERY = 0.04
"""Wall seconds between two reports to the pages."""
_RECENT = 20
"""Steps that a page is shown when it comes."""
_HALVES = 20
"""Steps kept of which one half has come: of one that is older the other half was refused."""
_ROUNDING = 1e-6
"""Seconds by which a page may be wrong about the end of a step, which it works out itself."""


class WebBench:
    """A rig with a person before it; lives in the event loop.

    Parameters
    ----------
    setup
        Of its rig.
    notebook
        Where the person's readings go.

    """

    def __init__(self, setup: BenchSetup, notebook: Notebook) -> None:
        self.setup = setup
        self.state = BenchState(setup.plant, setup.instruments, notebook, setup.rate)
        self.pages = PageClients()
        self.folders = [setup.bags]
        """Of the runs: one a rig."""
        self.failure: Message | None = None
        """What the rig died of; None while it lives."""
        self.plot_seen_in: int | None = None
        """The run in which the person looks at θ(t); in the next one it is covered again."""
        self.plot_noted_in = 0
        """The last run of which the book says so."""
        self.sitting = secrets.token_hex(4)
        """Tells a page that it has another bench before it, whose runs count anew."""
        self.rig_readings_seen = False
        """Whether the person looks at what the rig's own instruments read."""
        self.fit = BookFit(setup.shown, setup.amplitude_sigma, self.changed)
        self.controls: BenchControls | None = None
        self._rig: Rig | None = None
        self._halves: dict[StepId, dict[str, SampledMotion]] = {}
        """What has come of steps of which pivot or pendulum is missing yet: they come in either order."""
        self._loop = asyncio.get_running_loop()
        self._changed = asyncio.Event()
        self._repairing = asyncio.Lock()
        self._recent: deque[bytes] = deque(maxlen=_RECENT)
        self._said: tuple[object, ...] = (None, None, None)
        self._only_moved = False
        """Whether there is nothing to tell but the motion, which pages are shown at once."""

    @property
    def plot_seen(self) -> bool:
        """Whether the person looks at θ(t)."""
        return self.plot_seen_in == self.state.run

    @property
    def runs(self) -> bool:
        """Whether there is a rig that has begun a run."""
        return self.failure is None and self._rig is not None and self.state.run > self.state.runs_before

    async def start(self) -> None:
        """Start a rig.

        Raises
        ------
        KapitsaError
            It cannot be started.

        """
        folder, rate = self.folders[-1], self.state.clock.rate
        make_writable(folder)
        setup = self.setup
        rig = Rig(
            setup.plant,
            setup.instruments,
            setup.seed_of_rig(len(self.folders)),
            rate,
            bags=folder,
            protocol=MANUAL,
            composed=setup.composed,
            steps=setup.steps,
        )
        self._rig = await asyncio.to_thread(rig.__enter__)
        self.controls = BenchControls(self._rig, self.state, self._post, self._receive_failure, self._receive)
        self.controls.start()
        self.changed()

    async def end(self) -> None:
        """End the run, so that its bag is complete, and stop the rig."""
        if self.runs and self.controls is not None:
            ended = asyncio.Event()
            self.controls.end_run(ended.set)
            try:
                async with asyncio.timeout(PATIENCE):
                    await ended.wait()
            except TimeoutError:
                self.state.notify('the run could not be ended: its bag says so')
        await self._stop_rig()

    async def repair(self) -> None:
        """Start another rig in place of one that died, with the run that comes next."""
        async with self._repairing:
            if self.failure is None:
                return
            await self._stop_rig()
            speed = self.state.speed
            self.state.runs_before = self.state.run
            self.add_folder()
            self.state.set_paused(paused=False)
            try:
                await self.start()
            except (KapitsaError, OSError) as error:
                self.failure = said_of(error)
            else:
                self.failure = None
                if speed and self.controls is not None:
                    self.controls.set_speed(speed)
        self.changed()

    def hand_in(self, values: dict[str, Any]) -> None:  # noqa: ARG002
        """Take what the person hands in.

        Raises
        ------
        PageRequestError
            There is nobody to hand it to.

        """
        raise PageRequestError('this bench is of no class: there is nobody to hand in to')

    def add_folder(self) -> None:
        """Let the runs of the next rig go to a folder of its own."""
        self.folders.append(self.folders[0] / f'rig_{len(self.folders) + 1}')

    def now(self) -> float:
        """Return the simulated time, s of the run."""
        return self.state.clock.now(time.monotonic())

    def press_watch(self, moment: float) -> None:
        """Start or stop the stopwatch, by a person who saw the motion of a moment, s of the run.

        That moment is the page's to say, however late it shows the motion: what was seen is what is timed.

        Raises
        ------
        PageRequestError
            No page can have shown that moment of this run.
        InstrumentError
            The watch was started after it.

        """
        known = self.state.clock.known
        if not 0.0 <= moment <= known + _ROUNDING:
            raise PageRequestError(
                'not timed: pressed at {moment:.1f} s, of this run {known:.1f} s were seen', moment=moment, known=known
            )
        self.state.press_watch(moment)

    def changed(self) -> None:
        """Have the pages told what is different now."""
        self._changed.set()

    async def tell_pages(self) -> None:
        """Tell all pages of every change, at most 25 times a second; goes on until it is cancelled."""
        while True:
            with suppress(TimeoutError):  # somebody may have left
                async with asyncio.timeout(1.0):  # `wait_for` of Python 3.11 may lose a cancellation
                    await self._changed.wait()
            self._changed.clear()
            self.tell_all()
            await asyncio.sleep(_TOLD_EVERY)

    def tell_all(self) -> None:
        """Tell all pages how things are."""
        self.pages.hand_on(time.monotonic())
        for page in self.pages:
            self.tell(page)

    def tell(self, page: PageClient) -> None:
        """Tell a page how things are."""
        for kind, text in report(self, page).items():
            page.tell(kind, text)

    def welcome(self, page: PageClient) -> None:
        """Tell a page that has just come how things are, and what was seen last."""
        self.tell(page)
        for frame in self._recent:
            page.show(frame)

    def _receive(self, news: list[News]) -> None:
        for topic, step_id, value in news:
            if topic not in {PIVOT.name, MOTION.name}:
                continue
            found = self._halves.setdefault(step_id, {})
            found[topic] = value
            if len(found) == 2:  # pivot and pendulum
                del self._halves[step_id]
                self._show(step_id, found[MOTION.name], found[PIVOT.name])
        while len(self._halves) > _HALVES:
            del self._halves[next(iter(self._halves))]
        self.state.check_fall(self.now())
        self._only_moved = not self._has_said_more()

    def _has_said_more(self) -> bool:
        """Whether the rig, since this was last asked, has said more than how it moves."""
        state = self.state
        said = (state.run, *(each[-1] if each else None for each in (state.messages, state.rig_readings)))
        before, self._said = self._said, said
        return any(new is not old for new, old in zip(said, before, strict=True))

    def _show(self, step_id: StepId, pendulum: SampledMotion, pivot: SampledMotion) -> None:
        start = step_id.step * pendulum.duration
        flashes = self.state.lamp.flashes(start, start + pendulum.duration)
        frame = encode_motion(
            self.state.runs_before + step_id.run, start, pendulum, pivot, flashes, scale=self.setup.scale
        )
        self._recent.append(frame)
        for page in self.pages:
            page.show(frame)

    def _receive_failure(self, error: RigError) -> None:
        self.failure = said_of(error)
        self.changed()

    async def _stop_rig(self) -> None:
        controls, self.controls = self.controls, None
        rig, self._rig = self._rig, None
        if controls is not None:
            await asyncio.to_thread(controls.stop)
        if rig is not None:
            await asyncio.to_thread(rig.__exit__, None, None, None)

    def _post(self, act: Callable[[], None]) -> None:
        """Have a call made in the event loop; called from any thread."""

        def make() -> None:
            self._only_moved = False
            act()
            if not self._only_moved:
                self.changed()

        with suppress(RuntimeError):  # the loop is over, and with it the bench
            self._loop.call_soon_threadsafe(make)
