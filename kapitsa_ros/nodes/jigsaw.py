"""The jigsaw: moves the pivot as commanded, and owns time.

It emits the pivot's motion over step n when it has the command for step n, and the readers that acknowledge steps are
no more than `in_flight` steps behind. A reset ends the run before its next step: the operator, who sees the end, opens
the next run.
"""

from __future__ import annotations

from collections import deque
from dataclasses import asdict
from typing import TYPE_CHECKING

from std_srvs.srv import Trigger

from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.configuration.step_parameters import StepParameters
from kapitsa_ros.network.registry import COMMAND, JIGSAW, PIVOT
from kapitsa_ros.network.step_clock import SECOND, StepClock
from kapitsa_ros.network.step_id import StepId, ends_session
from kapitsa_ros.physics.jigsaw import Jigsaw
from kapitsa_ros.physics.jigsaw_parameters import JigsawParameters
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.ros.clock_publisher import ClockPublisher
from kapitsa_ros.ros.dataflow_node import IDLE, DataflowNode
from kapitsa_ros.ros.errors import NodeError, SettingError
from kapitsa_ros.ros.parameters import declare_set, settings_text
from kapitsa_ros.ros.progress_reporter import ProgressReporter
from kapitsa_ros.ros.stall_warning import StallWarning
from kapitsa_ros.ros.time_control import TimeControl
from kapitsa_ros.units import RPM
from kapitsa_ros.versions import versions

if TYPE_CHECKING:
    from kapitsa_ros.operator.command import Command


class JigsawNode(DataflowNode):
    """Executable `jigsaw`."""

    def __init__(self) -> None:
        super().__init__(JIGSAW)
        parameters = declare_set(self, StepParameters)
        try:
            self._count = parameters.samples
        except ConfigurationError as error:
            raise SettingError(f'parameter {error}') from error
        self._steps = StepClock(parameters.step_ns)
        self._in_flight = parameters.in_flight
        self._plant = declare_set(self, Plant, 'amplitude')
        self._motion = declare_set(self, JigsawParameters)
        self._time = TimeControl(self, next_step=lambda: self._next)
        self.create_service(Trigger, '~/reset', self._reset)
        self._jigsaw = self._at_rest()
        self._commands: deque[tuple[StepId, Command]] = deque()
        self._acknowledged: dict[str, StepId | None] = {t.name: None for t in self.reads if t is not COMMAND}
        self._next = StepId(1, 0)
        self._stall_warning = StallWarning(self)
        self._cut_short = 0
        """The last run that a reset has ended; its operator may be ahead of the news."""
        self._clock_publisher = ClockPublisher(self)
        self._progress = ProgressReporter(self, self._time.pace)
        self.latch_settings(
            settings_text(
                'jigsaw',
                amplitude=self._plant.amplitude,
                versions=versions(),
                **asdict(parameters),
                **asdict(self._motion),
            )
        )

    def accept(self, topic: str, step_id: StepId, raw: bytes) -> bool:
        """Queue a command, or note an acknowledgement."""
        if topic != COMMAND.name:
            if (step_id.run, step_id.step) >= (self._next.run, self._next.step):
                raise NodeError(f'{topic} acknowledges {step_id}, and {self._next} is next: it has a second writer')
            self._acknowledged[topic] = step_id
            return True
        if step_id.run == self._cut_short:
            return True
        if (step_id.run, step_id.step) < (self._next.run, self._next.step + len(self._commands)):
            return False
        command = COMMAND.decode(raw)
        if not 0 <= command.speed <= self._motion.max_speed:
            fastest = self._motion.max_speed / RPM
            raise NodeError(f'a command wants {command.speed / RPM:.0f} RPM: this jigsaw does 0 to {fastest:.0f} RPM')
        self._commands.append((step_id, command))
        return True

    def advance(self) -> float:
        """Emit every step that is commanded, acknowledged and due."""
        while not self.finished and self._may_go():
            wait = self._time.pace.wait(self._steps.start_ns(self._next) / SECOND)
            if wait > 0:
                return wait
            self._emit_step(*self._commands.popleft())
        return IDLE

    def poll(self) -> float:
        """Do what is due, and watch for those who keep time waiting."""
        wait = super().poll()
        if self._peers.matched:
            self._stall_warning.note(self._next, () if self._time.stands_still else self._awaited())
            if self._time.stands_still:
                self._clock_publisher.repeat(self._steps.start_ns(self._next))
        return wait

    def _may_go(self) -> bool:
        if self._time.stands_still or self._awaited():
            return False
        step_id = self._commands[0][0]
        if (step_id.run, step_id.step) != (self._next.run, self._next.step):
            raise NodeError(
                f'command for {step_id} where {self._next} is next: operator and jigsaw need the same in_flight'
            )
        return True

    def _awaited(self) -> list[str]:
        """Return the names of the topics that have to say more before the next step."""
        late = [topic for topic, ack in self._acknowledged.items() if not self._has_caught_up(ack)]
        return late if self._commands else [COMMAND.name, *late]

    def _has_caught_up(self, ack: StepId | None) -> bool:
        """Whether a reader is close enough behind, and through with the run before."""
        run, step = self._next.run, self._next.step
        if step == 0:
            return run == 1 or (ack is not None and ack.end and ack.run == run - 1)
        behind = step - self._in_flight
        return behind < 0 or (ack is not None and ack.run == run and ack.step >= behind)

    def _reset(self, _: Trigger.Request, answer: Trigger.Response) -> Trigger.Response:
        if self._next.step:
            self._commands.clear()
            self._cut_short = self._next.run
            self.get_logger().info(f'run {self._next.run} is reset before step {self._next.step}, by jigsaw/reset')
            self._end_run(StepId(self._next.run, self._next.step, end=True))
        answer.success, answer.message = True, str(self._next)
        return answer

    def _emit_step(self, step_id: StepId, command: Command) -> None:
        if step_id.end:
            self._end_run(step_id)
            return
        stamp = self._steps.start_ns(step_id)
        samples = self._jigsaw.advance(command.speed, self._steps.step, self._count)
        self.emit(PIVOT, step_id, stamp, samples)
        self._next = StepId(step_id.run, step_id.step + 1)
        self._tell(step_id, stamp)

    def _end_run(self, step_id: StepId) -> None:
        stamp = self._steps.start_ns(step_id)
        self.emit_silence(PIVOT, step_id, stamp)
        self._jigsaw = self._at_rest()
        self._next = StepId(step_id.run + 1, 0)
        self._tell(step_id, stamp)
        if ends_session(step_id):
            self.finish()

    def _at_rest(self) -> Jigsaw:
        return Jigsaw(amplitude=self._plant.amplitude, parameters=self._motion)

    def _tell(self, step_id: StepId, stamp: int) -> None:
        """Publish clock and progress, no more often than their readers need."""
        self._time.count(stamp / SECOND)
        self._clock_publisher.publish(stamp, is_last=self._time.stands_still)
        self._progress.tell(step_id, stamp)


create = JigsawNode
