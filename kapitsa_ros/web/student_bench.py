"""A bench of a class: its rod is sealed, it outlives its server, and it sleeps while nobody looks."""

from __future__ import annotations

import asyncio
import json
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros.analysis.experiment import true_threshold
from kapitsa_ros.bench.notebook import Notebook
from kapitsa_ros.configuration.step_parameters import StepParameters
from kapitsa_ros.errors import KapitsaError, said_of
from kapitsa_ros.message import Message
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.naming import run_folders
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.units import RPM
from kapitsa_ros.web.bench_setup import BenchSetup
from kapitsa_ros.web.class_folder import now_text
from kapitsa_ros.web.errors import PageRequestError
from kapitsa_ros.web.hand_in import HandIn, parse_hand_in
from kapitsa_ros.web.web_bench import WebBench

if TYPE_CHECKING:
    from kapitsa_ros.configuration.class_settings import ClassSettings
    from kapitsa_ros.web.class_folder import BenchFolder
    from kapitsa_ros.web.page_client import PageClient

STEPS = StepParameters(step=0.4, in_flight=1)
"""Half of the messages of a single bench, as a class has many, and as much time in flight."""
SLEEP_AFTER = 20.0
"""Wall seconds without a page after which time stands still at a bench."""
MOST_HAND_INS = 100
_NOTED = Message('run {run} was cut off; {seconds:.1f} s of it are recorded')
_CUT = Message(
    'the server was ended in run {run}, of which {seconds:.1f} s are recorded; the next run has the speed that was set'
)


class StudentBench(WebBench):
    """The bench of one student; lives in the event loop.

    Parameters
    ----------
    number
        From 1.
    folder
        Of its files; what is there is gone on with.
    settings
        Of the class.
    starts
        Bounds how many rigs start at a time.

    """

    def __init__(self, number: int, folder: BenchFolder, settings: ClassSettings, starts: asyncio.Semaphore) -> None:
        self.number = number
        self.record = folder.record()
        self.hand_ins = folder.hand_ins()
        self._folder = folder
        self._settings = settings
        self._starts = starts
        plant = folder.sealed()
        stroke, sigma = settings.told_amplitude
        setup = BenchSetup(
            plant=plant,
            instruments=settings.instruments,
            seed=settings.numbers.seed + number,
            rate=settings.numbers.rate,
            fastest_rate=settings.numbers.fastest_rate,
            bags=folder.runs,
            shown=type(plant)(length=self.record.told_length, amplitude=stroke, gravity=plant.gravity),
            amplitude_sigma=sigma,
            composed=True,
            steps=STEPS,
        )
        super().__init__(setup, Notebook(folder.book, continued=True))
        self._begun: asyncio.Task[None] | None = None
        self._marked: asyncio.Task[None] | None = None
        self._left_at = time.monotonic()
        self._asleep = False
        self._ending = False
        self._truth: float | None = None
        self._truth_known = False
        self._said_unwritten = False
        self._go_on()

    @property
    def asleep(self) -> bool:
        """Whether time stands still because nobody looks."""
        return self._asleep

    @property
    def is_starting(self) -> bool:
        """Whether its rig is being started, or waits for its turn."""
        return self._begun is not None and not self._begun.done()

    async def begin(self) -> None:
        """Have the rig started, where there is none and nothing went wrong."""
        if self._marked is not None:
            await asyncio.shield(self._marked)
        if self._begun is None and self._rig is None and self.failure is None:
            self._begun = asyncio.get_running_loop().create_task(self._begin())

    async def repair(self) -> None:
        """Start another rig in place of one that died, or was cut off with the server."""
        async with self._starts:
            self._asleep = False
            await super().repair()

    async def end(self) -> None:
        """End the run, so that its bag is complete, and stop the rig; one that is being started, once it has."""
        self._ending = True
        for task in (self._marked, self._begun):
            if task is not None:
                await task
        under_way = self.runs
        await super().end()
        if under_way:
            self._save(under_way=False)

    def tell_all(self) -> None:
        """Tell all pages how things are, write them down, and let the bench sleep or wake."""
        super().tell_all()
        if self.runs:
            self._save(under_way=True)
        self.look_after(time.monotonic())

    def tell(self, page: PageClient) -> None:
        """Tell a page how things are."""
        super().tell(page)
        page.tell('class', json.dumps({'kind': 'class'} | self._told_of_class(), allow_nan=False))

    def hand_in(self, values: dict[str, Any]) -> None:
        """Take what the student hands in; the last counts, all are kept.

        Raises
        ------
        PageRequestError
            It cannot be meant, or not be kept.

        """
        value, low, high = parse_hand_in(values)
        if len(self.hand_ins) >= MOST_HAND_INS:
            raise PageRequestError('{most} were handed in already', most=MOST_HAND_INS)
        book = self.state.notebook
        handed_in = HandIn(
            omega_crit_rpm=value,
            low_rpm=low,
            high_rpm=high,
            when=now_text(),
            readings=len(book.rows),
            book=book.text(),
        )
        try:
            self._folder.add(handed_in)
        except OSError as error:
            raise PageRequestError('it could not be kept: {why}', why=error.strerror) from error
        self.hand_ins.append(handed_in)
        self.state.notify('handed in: {value:.6g} RPM, {low:.6g} to {high:.6g} RPM', value=value, low=low, high=high)
        self.changed()

    def assign(self, name: str) -> None:
        """Give the bench to a student.

        Raises
        ------
        OSError
            The disk does not take it.

        """
        record = replace(self.record, name=name, joined=now_text())
        self._folder.save(record)
        self.record = record

    async def truth(self) -> float | None:
        """Return the exact threshold of the sealed rod, RPM; None where it has none."""
        if not self._truth_known:
            found = await asyncio.to_thread(true_threshold, self.setup.plant)
            self._truth, self._truth_known = None if found is None else found / RPM, True
        return self._truth

    async def _begin(self) -> None:
        async with self._starts:
            if self._ending:
                return
            try:
                await self.start()
            except (KapitsaError, OSError) as error:
                self.failure = said_of(error)
        self.changed()

    def _go_on(self) -> None:
        """Take up where an earlier server left the bench."""
        if self.state.notebook.rows:
            self.fit.begin(self.state.notebook.path, len(self.state.notebook.rows))
        if not self.record.run:
            return
        self.folders = self._folder.rig_folders()
        self.state.run = self.state.runs_before = self.record.run
        if not self.record.under_way:
            self.add_folder()
            return
        self.state.speed = self.record.speed_rpm
        self._marked = asyncio.get_running_loop().create_task(self._mark_cut())

    async def _mark_cut(self) -> None:
        """Note in the book that the last run was cut off, and offer the next."""
        async with self._starts:
            seconds = await asyncio.to_thread(self._recorded_seconds)
        note = Message(_NOTED, run=self.record.run, seconds=seconds)
        try:
            if note not in self.state.notebook.lines:
                self.state.notebook.note(note)
        except OSError as error:
            self.state.notify('not written down: {why}', why=error)
        self.failure = Message(_CUT, run=self.record.run, seconds=seconds)
        self.changed()

    def _recorded_seconds(self) -> float:
        try:
            stamps = RunBag(run_folders([self.folders[-1]])[-1]).motion.stamps_ns
            return float(np.ptp(stamps)) / SECOND if stamps.size else 0.0
        except BagError:
            return 0.0

    def look_after(self, now: float) -> None:
        """Let time stand still where nobody has looked for a while, and run again for who comes; `now` is wall time."""
        if list(self.pages):
            self._left_at = now
            if self._asleep and self.state.paused and self.controls is not None:
                self._asleep = False
                self.controls.toggle_pause()
        elif now - self._left_at > SLEEP_AFTER and self.runs and not (self._asleep or self.state.paused):
            self._asleep = True
            if self.controls is not None:
                self.controls.toggle_pause()

    def _save(self, *, under_way: bool) -> None:
        record = replace(self.record, run=self.state.run, under_way=under_way, speed_rpm=self.state.speed)
        if record == self.record:
            return
        try:
            self._folder.save(record)
        except OSError as error:
            if not self._said_unwritten:
                self._said_unwritten = True
                self.state.notify('the state of the bench cannot be written: {why}', why=error.strerror)
        else:
            self.record = record

    def _told_of_class(self) -> dict[str, Any]:
        last = self.hand_ins[-1] if self.hand_ins else None
        return {
            'bench': self.number,
            'name': self.record.name,
            'told_length': self.record.told_length,
            'ruler_error': self._settings.numbers.ruler_error,
            'told_stroke': [2.0 * each for each in self._settings.told_amplitude],
            'handed_in': len(self.hand_ins),
            'last': None if last is None else [last.omega_crit_rpm, last.low_rpm, last.high_rpm],
        }
