"""The player: puts a bag back on the topics it was recorded from, as fast as the analyser takes it or paced."""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from kapitsa_ros.configuration.rig_parameters import RigParameters
from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import MOTION, PIVOT, PLAYER, REPLAYED
from kapitsa_ros.network.settings import SETTINGS_TYPE, settings_topic
from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.network.step_id import StepId, ends_session
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.ros.clock_publisher import ClockPublisher
from kapitsa_ros.ros.dataflow_node import IDLE, DataflowNode
from kapitsa_ros.ros.diagnostics import progress_message
from kapitsa_ros.ros.errors import SettingError
from kapitsa_ros.ros.joint_state_publisher import JointStatePublisher
from kapitsa_ros.ros.parameters import declare, declare_quantity
from kapitsa_ros.ros.qos import LATCHED, message_class
from kapitsa_ros.ros.real_time_pacer import RealTimePacer
from kapitsa_ros.ros.throttle import REPORT_PERIOD, Throttle

if TYPE_CHECKING:
    from collections.abc import Iterator

WINDOW = 8
"""Steps under way at once."""


class PlayerNode(DataflowNode):
    """Executable `player`."""

    def __init__(self) -> None:
        super().__init__(PLAYER)
        paths = declare(self, 'bags', [''], 'folders of the runs to play, in this order')
        self._pace = RealTimePacer(declare_quantity(self, RigParameters, 'rate'))
        if not any(paths):
            raise SettingError('parameter bags is empty: give one run or more')
        try:
            self._bags = [RunBag(Path(path)) for path in paths]
        except BagError as error:
            raise SettingError(f'parameter bags: {error}') from error
        self._text = message_class(SETTINGS_TYPE)
        self._latched = {
            node: self.create_publisher(self._text, settings_topic(node), LATCHED)
            for node in self._bags[0].settings_texts
        }
        self._report = Throttle(REPORT_PERIOD)
        self._clock_publisher, self._joint_states = ClockPublisher(self), JointStatePublisher(self)
        self._under_way: deque[StepId] = deque()
        self._playing = self._bags[0]
        self._steps = self._play()
        self._next = next(self._steps)

    def accept(self, topic: str, step_id: StepId, raw: bytes) -> bool:  # noqa: ARG002
        """Note that a step has been analysed."""
        if not self._under_way or step_id != self._under_way[0]:
            return False
        self._under_way.popleft()
        return True

    def advance(self) -> float:
        """Play every step that is due, a window ahead of the analyser at most."""
        while not self.finished:
            step_id, stamp, messages = self._next
            # A run begins when the one before has been analysed, since settings are not numbered.
            if len(self._under_way) > (WINDOW if step_id.step else 0):
                return IDLE
            wait = self._pace.wait(stamp / SECOND)
            if wait > 0:
                return wait
            if step_id.step == 0 and not step_id.end:
                self._latch(self._playing)
            for topic in REPLAYED:
                if topic.name in messages:
                    self.emit_raw(topic, messages[topic.name])
                elif step_id.end or topic.name not in self._playing.topics:
                    # The bag is older than the role: silence stands for its messages.
                    self.emit_silence(topic, step_id, stamp)
            self._under_way.append(step_id)
            self._show(step_id, stamp, messages)
            self._pace.count(stamp / SECOND)
            if self._report.due() or step_id.end:
                self.diagnostics.publish(progress_message('player', step_id, stamp, self._pace))
            if ends_session(step_id):
                self.finish()
            else:
                self._next = next(self._steps)
        return IDLE

    def poll(self) -> float:
        """Do what is due, and show viewers what is."""
        return min(super().poll(), self._joint_states.refresh())

    def _show(self, step_id: StepId, stamp: int, messages: dict[str, bytes]) -> None:
        self._clock_publisher.publish(stamp)
        if not step_id.end:
            with suppress(KeyError, WireError):  # a bag that viewers cannot use may still be analysed
                pivot, motion = messages[PIVOT.name], messages[MOTION.name]
                self._joint_states.offer(stamp, lambda: (PIVOT.decode(pivot), MOTION.decode(motion)))

    def _play(self) -> Iterator[tuple[StepId, int, dict[str, bytes]]]:
        """Yield number, stamp and messages of every step of every bag; then the end of the session."""
        names = [topic.name for topic in REPLAYED]
        step_id, stamp = StepId(0, 0), 0
        for bag in self._bags:
            self._playing = bag
            for step_id, step in groupby(bag.raw(*names), key=lambda message: read_step_id(message[2])):
                messages = {}
                for topic, stamp, raw in step:  # noqa: B007
                    messages[topic] = raw
                yield step_id, stamp, messages
            if not step_id.end:
                yield StepId(step_id.run, step_id.step + 1, end=True), stamp, {}
        yield StepId(step_id.run + 1, 0, end=True), (step_id.run + 1) * DAY, {}

    def _latch(self, bag: RunBag) -> None:
        for node, publisher in self._latched.items():
            publisher.publish(self._text(data=bag.settings_texts[node]))
            self.wait_until_taken(publisher)


create = PlayerNode
