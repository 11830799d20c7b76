"""The operator: carries out a protocol, one command a step, each made from the readings of `in_flight` steps before."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.instruments.errors import ProtocolError
from kapitsa_ros.instruments.operator import Command, Operator
from kapitsa_ros.instruments.protocol import load_protocol
from kapitsa_ros.nodes.errors import SettingError
from kapitsa_ros.nodes.parameters import declare
from kapitsa_ros.nodes.stage import JoinedStage
from kapitsa_ros.physics.steps import SECOND, StepClock, Tick, ends_session
from kapitsa_ros.recording import topics
from kapitsa_ros.recording.messages import decode_stopwatch, decode_strobe, encode_command

if TYPE_CHECKING:
    from collections.abc import Iterator


class OperatorNode(JoinedStage):
    """Executable `operator`."""

    def __init__(self) -> None:
        super().__init__('operator', reads=(topics.STROBE, topics.STOPWATCH), writes=(topics.COMMAND,))
        name = declare(self, 'protocol', '1997', 'name of a shipped protocol or path of a YAML file')
        self._in_flight = declare(self, 'in_flight', 4, 'steps under way at once; the jigsaw is told the same', 1, 100)
        step = declare(self, 'step', 0.1, 'length of a communication step, s', 0.001, 1.0)
        self._steps = StepClock(round(step * SECOND))
        try:
            self._protocol = load_protocol(name)
        except ProtocolError as error:
            raise SettingError(f'parameter protocol: {error}') from error
        self._speeds: Iterator[float] = iter(self._protocol.speeds)
        self._operator: Operator | None = None
        self._ended = False

    def advance(self) -> float:
        """Open the first run as soon as everyone is there; then answer readings."""
        if self._operator is None and not self._ended:
            self._open_run(1)
        return super().advance()

    def work(self, tick: Tick, messages: dict[str, bytes]) -> None:
        """Answer the readings of one step, unless the run has been ended already."""
        if self._ended or self._operator is None:
            return
        command = self._operator.command(
            decode_strobe(messages[topics.STROBE.name]), decode_stopwatch(messages[topics.STOPWATCH.name])
        )
        self._ended = command.end
        self._say(Tick(tick.run, tick.step + self._in_flight), command)

    def end_run(self, tick: Tick, stamp_ns: int, messages: dict[str, bytes]) -> None:  # noqa: ARG002
        """Open the next run."""
        if not ends_session(tick):
            self._open_run(tick.run + 1)

    def _open_run(self, run: int) -> None:
        """Say what holds until the first reading can be answered; or, after the last run, that none follows."""
        speed = next(self._speeds, None)
        self._ended = speed is None
        if speed is None:
            self._say(Tick(run, 0), Command(0.0, None, end=True))
            return
        self._operator = Operator(self._protocol, speed, self._steps.step)
        for step in range(self._in_flight):
            self._say(Tick(run, step), self._operator.opening())

    def _say(self, tick: Tick, command: Command) -> None:
        self.emit(topics.COMMAND, encode_command(self._steps.start_ns(tick), tick, command))


create = OperatorNode
