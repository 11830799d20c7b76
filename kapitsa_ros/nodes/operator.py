"""The operator: one command a step, each made from the readings of `in_flight` steps before, or from a person's wishes.

It carries out a protocol, run after run; with the protocol `manual` it carries out the requests on `operator/speed` and
`operator/release` to the next free step, and with a recorded run the commands in it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import repeat
from pathlib import Path
from typing import TYPE_CHECKING

from std_msgs.msg import Float64

from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.configuration.step_parameters import StepParameters
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import COMMAND, OPERATOR, STOPWATCH_READING, STROBE_READING
from kapitsa_ros.network.step_clock import StepClock
from kapitsa_ros.network.step_id import StepId, ends_session
from kapitsa_ros.operator.command import Command
from kapitsa_ros.operator.errors import ProtocolError, RequestError
from kapitsa_ros.operator.manual_operator import ManualOperator
from kapitsa_ros.operator.protocol import MANUAL
from kapitsa_ros.operator.recorded_operator import RecordedOperator
from kapitsa_ros.operator.requests import Requests
from kapitsa_ros.operator.scripted_operator import ScriptedOperator
from kapitsa_ros.physics.jigsaw_parameters import JigsawParameters
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.ros.errors import SettingError
from kapitsa_ros.ros.parameters import declare, declare_quantity, declare_set
from kapitsa_ros.ros.step_node import StepNode

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kapitsa_ros.network.step import Step


Begin = Callable[[], ScriptedOperator | ManualOperator | RecordedOperator]
"""Begins a run."""


class OperatorNode(StepNode):
    """Executable `operator`."""

    def __init__(self) -> None:
        super().__init__(OPERATOR)
        name = declare(
            self, 'protocol', '1997', f'name of a shipped protocol, path of a YAML file or a recorded run, or {MANUAL}'
        )
        release = declare(self, 'release', 0.12, 'angle at which a manual run begins, rad', -1.5, 1.5)
        fastest = declare_quantity(self, JigsawParameters, 'max_speed')
        parameters = declare_set(self, StepParameters, 'step', 'in_flight')
        self._in_flight, self._steps = parameters.in_flight, StepClock(parameters.step_ns)
        if name == MANUAL:
            requests = self._heed(Requests(fastest))
            self._runs: Iterator[Begin] = repeat(partial(ManualOperator, requests, release, self._steps.step))
        elif Path(name).is_dir():
            self._runs = self._repeat(Path(name))
        else:
            self._runs = self._carry_out(name)
        self._begin: Begin | None = None
        """Of the run under way; None: nobody was there yet, or no run is left."""
        self._run: ScriptedOperator | ManualOperator | RecordedOperator
        self._end: StepId | None = None
        """Step at which the current run was commanded to end."""

    def advance(self) -> float:
        """Open the first run as soon as everyone is there; then answer readings."""
        if self._begin is None and self._end is None:
            self._open_run(1, next(self._runs))
        return super().advance()

    def work(self, step: Step) -> None:
        """Answer the readings of one step, unless the run has been ended already."""
        if self._end is None:
            command = self._run.command(step[STROBE_READING], step[STOPWATCH_READING])
            self._command(StepId(step.id.run, step.id.step + self._in_flight, end=command.end), command)

    def end_run(self, step: Step) -> None:
        """Open the next run: the same again, if this one did not end where it was commanded to."""
        if not ends_session(step.id):
            as_commanded, self._end = step.id == self._end, None
            self._open_run(step.id.run + 1, next(self._runs, None) if as_commanded else self._begin)

    def _open_run(self, run: int, begin: Begin | None) -> None:
        """Say what holds until the first reading can be answered; or, after the last run, that none follows."""
        self._begin = begin
        if begin is None:
            self._command(StepId(run, 0, end=True), Command(0.0, None, end=True))
            return
        self._run = begin()
        for step in range(self._in_flight):
            self._command(StepId(run, step), self._run.opening())

    def _carry_out(self, name: str) -> Iterator[Begin]:
        try:
            protocol = load_protocol(name)
        except ProtocolError as error:
            raise SettingError(f'parameter protocol: {error}') from error
        return iter([partial(ScriptedOperator, protocol, speeds, self._steps.step) for speeds in protocol.runs])

    def _repeat(self, path: Path) -> Iterator[Begin]:
        """Do once more what was commanded in a recorded run; runs before it, whose numbers it needs, are cut short."""
        try:
            bag = RunBag(path)
            commands = [COMMAND.decode(raw) for _, _, raw in bag.raw(COMMAND.name)]
        except (BagError, WireError) as error:
            raise SettingError(f'parameter protocol: {error}') from error
        given = [command for command in commands if not command.end]
        return iter([*[partial(RecordedOperator, ())] * (bag.number - 1), partial(RecordedOperator, given)])

    def _heed(self, requests: Requests) -> Requests:
        """Take requests from their topics; refused ones are counted, and logged at intervals."""

        def taker(ask: Callable[[float], None]) -> Callable[[Float64], None]:
            def take(message: Float64) -> None:
                try:
                    ask(message.data)
                except RequestError as error:
                    self.refuse(str(error))

            return take

        self.create_subscription(Float64, 'operator/speed', taker(requests.ask_speed), 10)
        self.create_subscription(Float64, 'operator/release', taker(requests.ask_release), 10)
        return requests

    def _command(self, step_id: StepId, command: Command) -> None:
        if command.end:
            self._end = step_id
        self.emit(COMMAND, step_id, self._steps.start_ns(step_id), command)


create = OperatorNode
