"""The player: puts a bag back on the topics it was recorded from, as fast as the analyser takes it or paced."""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from kapitsa_ros.nodes.errors import SettingError
from kapitsa_ros.nodes.pace import Pace
from kapitsa_ros.nodes.parameters import declare
from kapitsa_ros.nodes.progress import progress_message
from kapitsa_ros.nodes.qos import LATCHED, message_class
from kapitsa_ros.nodes.screen import Screen
from kapitsa_ros.nodes.stage import IDLE, Stage
from kapitsa_ros.nodes.view import REPORT_PERIOD, ClockFace, Throttle
from kapitsa_ros.physics.steps import DAY, SECOND, Tick, ends_session
from kapitsa_ros.recording import topics
from kapitsa_ros.recording.errors import BagError, WireError
from kapitsa_ros.recording.messages import decode_samples
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.recording.wire import read_tick

if TYPE_CHECKING:
    from collections.abc import Iterator

WINDOW = 8
"""Steps under way at once."""


class PlayerNode(Stage):
    """Executable `player`."""

    def __init__(self) -> None:
        super().__init__('player', reads=(topics.RESULT,), writes=topics.PLAYED)
        paths = declare(self, 'bags', [''], 'folders of the runs to play, in this order')
        self._pace = Pace(declare(self, 'rate', 0.0, 'simulated over wall seconds; 0: as fast as it can', 0.0, 1e4))
        if not any(paths):
            raise SettingError('parameter bags is empty: give one run or more')
        try:
            self._bags = [RunBag(Path(path)) for path in paths]
        except BagError as error:
            raise SettingError(f'parameter bags: {error}') from error
        self._text = message_class(topics.SETTINGS_TYPE)
        self._latched = {
            node: self.create_publisher(self._text, topics.settings_topic(node), LATCHED)
            for node in self._bags[0].settings_texts
        }
        self._report = Throttle(REPORT_PERIOD)
        self._clock_face, self._screen = ClockFace(self), Screen(self)
        self._under_way: deque[Tick] = deque()
        self._playing = self._bags[0]
        self._steps = self._play()
        self._next = next(self._steps)

    def accept(self, topic: str, tick: Tick, raw: bytes) -> bool:  # noqa: ARG002
        """Note that a step has been analysed."""
        if not self._under_way or tick != self._under_way[0]:
            return False
        self._under_way.popleft()
        return True

    def advance(self) -> float:
        """Play every step that is due, a window ahead of the analyser at most."""
        while not self.finished:
            tick, stamp, messages = self._next
            # A run begins when the one before has been analysed, since settings are not numbered.
            if len(self._under_way) > (WINDOW if tick.step else 0):
                return IDLE
            wait = self._pace.wait(stamp / SECOND)
            if wait > 0:
                return wait
            if tick.step == 0 and not tick.end:
                self._latch(self._playing)
            for topic in topics.PLAYED:
                if topic.name in messages:
                    self.emit(topic, messages[topic.name])
                elif tick.end:
                    self.emit_silence(topic, tick, stamp)
            self._under_way.append(tick)
            self._show(tick, stamp, messages)
            self._pace.count(stamp / SECOND)
            if self._report.due() or tick.end:
                self.diagnostics.publish(progress_message('player', tick, stamp, self._pace))
            if ends_session(tick):
                self.finish()
            else:
                self._next = next(self._steps)
        return IDLE

    def poll(self) -> float:
        """Do what is due, and show viewers what is."""
        return min(super().poll(), self._screen.refresh())

    def _show(self, tick: Tick, stamp: int, messages: dict[str, bytes]) -> None:
        self._clock_face.show(stamp)
        if not tick.end:
            with suppress(KeyError, WireError):  # a bag that viewers cannot use may still be analysed
                pivot, motion = messages[topics.PIVOT.name], messages[topics.MOTION.name]
                self._screen.offer(stamp, lambda: (decode_samples(pivot), decode_samples(motion)))

    def _play(self) -> Iterator[tuple[Tick, int, dict[str, bytes]]]:
        """Yield number, stamp and messages of every step of every bag; then the end of the session."""
        names = [topic.name for topic in topics.PLAYED]
        tick, stamp = Tick(0, 0), 0
        for bag in self._bags:
            self._playing = bag
            for tick, step in groupby(bag.raw(*names), key=lambda message: read_tick(message[2])):
                messages = {}
                for topic, stamp, raw in step:  # noqa: B007
                    messages[topic] = raw
                yield tick, stamp, messages
            if not tick.end:
                yield Tick(tick.run, tick.step + 1, end=True), stamp, {}
        yield Tick(tick.run + 1, 0, end=True), (tick.run + 1) * DAY, {}

    def _latch(self, bag: RunBag) -> None:
        for node, publisher in self._latched.items():
            publisher.publish(self._text(data=bag.settings_texts[node]))
            self.wait_until_taken(publisher)


create = PlayerNode
