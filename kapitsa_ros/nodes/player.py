"""The player: puts a bag back on the topics it was recorded from, as fast as the analyser takes it or paced.

The analyser gets every step once and in order, however the runs are played: what is skipped is not shown to viewers,
and what is played again is shown to them alone. So its result does not depend on where one looked.
"""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from rcl_interfaces.msg import SetParametersResult

from kapitsa_ros.configuration.playback_parameters import LONGEST, PlaybackParameters
from kapitsa_ros.network.registry import MOTION, PIVOT, PLAYER, REPLAYED
from kapitsa_ros.network.settings import SETTINGS_TYPE, settings_topic
from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.playback import Playback, PlayedStep
from kapitsa_ros.recording.reader import runs_of
from kapitsa_ros.ros.clock_publisher import ClockPublisher
from kapitsa_ros.ros.dataflow_node import IDLE, DataflowNode
from kapitsa_ros.ros.errors import SettingError
from kapitsa_ros.ros.joint_state_publisher import JointStatePublisher
from kapitsa_ros.ros.model_publisher import ModelPublisher
from kapitsa_ros.ros.parameters import declare, declare_set
from kapitsa_ros.ros.progress_reporter import ProgressReporter
from kapitsa_ros.ros.qos import LATCHED, message_class
from kapitsa_ros.ros.time_control import TimeControl

if TYPE_CHECKING:
    from rclpy.parameter import Parameter

    from kapitsa_ros.recording.reader import RunBag

WINDOW = 8
"""Steps under way at once."""


class PlayerNode(DataflowNode):
    """Executable `player`. Parameter `seek`, s, moves to another place of the runs, at any time."""

    def __init__(self) -> None:
        super().__init__(PLAYER)
        paths = declare(self, 'bags', [''], 'folders of the runs to play, in this order')
        self._loop = declare(self, 'loop', default=False, description='begin again at the end, for viewers')
        self._part = declare_set(self, PlaybackParameters)
        declare(self, 'seek', self._part.start, 'place of the runs to go to, s', 0.0, LONGEST, read_only=False)
        self._time = TimeControl(self, next_step=self._next_id)
        if not any(paths):
            raise SettingError('parameter bags is empty: give one run or more')
        try:
            self._bags = runs_of(map(Path, paths))
        except BagError as error:
            raise SettingError(f'parameter bags: {error}') from error
        self._playback = Playback(self._bags)
        self._duration = self._playback.duration
        if self._part.start >= self._duration:
            raise SettingError(f'parameter start is {self._part.start:g} s: the runs last {self._duration:g} s')
        self._text = message_class(SETTINGS_TYPE)
        self._latched = {
            node: self.create_publisher(self._text, settings_topic(node), LATCHED)
            for node in self._bags[0].settings_texts
        }
        self._progress = ProgressReporter(self, self._time.pace)
        self._clock_publisher, self._joint_states = ClockPublisher(self), JointStatePublisher(self)
        ModelPublisher(self).publish(self._bags[0].run.plant)
        self._under_way: deque[StepId] = deque()
        self._emitted: PlayedStep | None = None
        """The last that the analyser was given."""
        self._analysed = False
        """Whether the analyser was told that no run follows."""
        self._steps = self._playback.steps()
        self._next: PlayedStep | None = next(self._steps)
        self._shown_from = self._part.start
        self._is_sought = False
        """Whether the next step that is shown is so even while time stands still."""
        self.add_on_set_parameters_callback(self._refuse_beyond_end)
        self.add_post_set_parameters_callback(self._take_parameters)

    def accept(self, topic: str, step_id: StepId, raw: bytes) -> bool:  # noqa: ARG002
        """Note that a step has been analysed."""
        if not self._under_way or step_id != self._under_way[0]:
            return False
        self._under_way.popleft()
        return True

    def advance(self) -> float:
        """Play every step that is due, a window ahead of the analyser at most."""
        while not self.finished:
            step = self._next
            if step is None or step.seconds > self._part.end:
                if not self._end_of_part():
                    return IDLE
                continue
            is_new = self._emitted is None or step.index > self._emitted.index
            is_shown = step.seconds >= self._shown_from
            wait = self._wait(step, is_new=is_new, is_shown=is_shown)
            if wait > 0:
                return wait
            if is_new:
                self._emit(step)
            if is_shown:
                self._show(step)
            self._next = next(self._steps, None)
            if is_shown and not is_new:
                return 0.0  # nobody is waited for: let services and signals have their turn
        return IDLE

    def pending(self) -> float:
        """Return the seconds until viewers are shown something."""
        return self._joint_states.wait()

    def poll(self) -> float:
        """Do what is due, and show viewers what is."""
        wait = super().poll()
        if self._peers.matched and self._time.stands_still and self._next is not None:
            self._clock_publisher.repeat(self._next.stamp_ns)
        return min(wait, self._joint_states.refresh())

    def _wait(self, step: PlayedStep, *, is_new: bool, is_shown: bool) -> float:
        """Return the seconds until a step is due; IDLE where something else has to happen before."""
        if is_shown and self._time.stands_still and not self._is_sought:
            self._tell(step)  # whoever starts a replay has to know that it stands, and where
            return IDLE
        # A run begins when the one before has been analysed, since settings are not numbered.
        if is_new and len(self._under_way) > (WINDOW if step.id.step else 0):
            return IDLE
        return self._time.pace.wait(step.stamp_ns / SECOND) if is_shown else 0.0

    def _emit(self, step: PlayedStep) -> None:
        if step.id.step == 0 and not step.id.end:
            self._latch(step.bag)
        for topic in REPLAYED:
            if topic.name in step.messages:
                self.emit_raw(topic, step.messages[topic.name])
            elif step.id.end or topic.name not in step.bag.topics:
                # The bag is older than the role: silence stands for its messages.
                self.emit_silence(topic, step.id, step.stamp_ns)
        self._under_way.append(step.id)
        self._emitted = step

    def _show(self, step: PlayedStep) -> None:
        if self._is_sought:
            self._is_sought = False
        else:
            self._time.count(step.stamp_ns / SECOND)
        self._clock_publisher.publish(step.stamp_ns, is_last=self._time.stands_still)
        if not step.id.end:
            with suppress(KeyError):  # a bag that viewers cannot use may still be analysed
                pivot, motion = step.messages[PIVOT.name], step.messages[MOTION.name]
                self._joint_states.offer(step.stamp_ns, lambda: (PIVOT.decode(pivot), MOTION.decode(motion)))
        self._tell(step)

    def _tell(self, step: PlayedStep) -> None:
        self._progress.tell(step.id, step.stamp_ns, paused=self._time.stands_still)

    def _end_of_part(self) -> bool:
        """End the session, once; then begin again, or leave. Return False while steps are being analysed."""
        if not self._analysed:
            if self._under_way:
                return False
            self._end_session()
            self._analysed = True
        if self._under_way:  # who watches takes a player that has left before the last result for one that was ended
            return False
        if self._loop:
            self._go_to(self._part.start)
        else:
            self.finish()
        return True

    def _end_session(self) -> None:
        last = self._emitted
        run, stamp = (last.id.run, last.stamp_ns) if last else (0, 0)
        ends = [StepId(run + 1, 0, end=True)]
        if last and not last.id.end:
            ends.insert(0, StepId(run, last.id.step + 1, end=True))
        for step_id in ends:
            self._under_way.append(step_id)
            for topic in REPLAYED:
                self.emit_silence(topic, step_id, stamp if step_id.run == run else (run + 1) * DAY)
        self._progress.tell(ends[-1], (run + 1) * DAY, paused=False)

    def _go_to(self, seconds: float) -> None:
        self._steps = self._playback.steps()
        self._shown_from = seconds
        self._next = next(self._steps, None)
        self._time.pace.restart()

    def _next_id(self) -> StepId:
        """Return the number of the next step that is shown."""
        return self._next.id if self._next is not None else StepId(self._bags[-1].run.number + 1, 0, end=True)

    def _refuse_beyond_end(self, parameters: list[Parameter]) -> SetParametersResult:
        beyond = any(parameter.name == 'seek' and parameter.value > self._duration for parameter in parameters)
        return SetParametersResult(successful=not beyond, reason=f'the runs last {self._duration:g} s' * beyond)

    def _take_parameters(self, parameters: list[Parameter]) -> None:
        for parameter in parameters:
            if parameter.name == 'seek':
                self._go_to(parameter.value)
                self._is_sought = True

    def _latch(self, bag: RunBag) -> None:
        for node, publisher in self._latched.items():
            publisher.publish(self._text(data=bag.settings_texts[node]))
            self.wait_until_taken(publisher)


create = PlayerNode
