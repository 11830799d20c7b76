"""Whole experiments in process: the same plant, instruments, person and steps as the graph, without its messages."""

from __future__ import annotations

from collections import deque
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from kapitsa_ros.instruments.random_streams import random_stream
from kapitsa_ros.instruments.stopwatch import Stopwatch
from kapitsa_ros.instruments.strobe import Strobe
from kapitsa_ros.laboratory.apparatus import STEPS, apparatus
from kapitsa_ros.network.registry import STOPWATCH_READING, STROBE_READING
from kapitsa_ros.network.run_builder import RunBuilder
from kapitsa_ros.operator.scripted_operator import ScriptedOperator

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.laboratory.apparatus import ApparatusStart
    from kapitsa_ros.network.run import Run
    from kapitsa_ros.operator.protocol import Protocol
    from kapitsa_ros.physics.plant import Plant


@dataclass(frozen=True, kw_only=True)
class SimulatedExperiment:
    """An experiment that gives the readings the graph would give with the same settings.

    Steps and jigsaw are those that the nodes have by default.
    """

    plant: Plant
    instruments: Instruments
    protocol: Protocol
    seed: int

    def runs(self) -> list[Run]:
        """Carry out the protocol."""
        settings = self._settings()
        return [self._run(number, speeds, settings) for number, speeds in enumerate(self.protocol.runs, start=1)]

    def _run(self, number: int, speeds: tuple[float, ...], settings: Mapping[str, Mapping[str, Any]]) -> Run:
        strobe = Strobe(self.instruments.strobe, random_stream(self.seed, 'strobe', number))
        watch = Stopwatch(
            self.instruments.stopwatch, self.protocol.swings, random_stream(self.seed, 'stopwatch', number)
        )
        operator = ScriptedOperator(self.protocol, speeds, STEPS.step)
        commands = deque([operator.opening()] * STEPS.in_flight)
        builder = RunBuilder(number, settings)
        last: ApparatusStart = apparatus(self.plant, self.instruments)
        while not (command := commands.popleft()).end:
            last = step = last.after(command)
            seen = strobe.search(step.swing.end, step.steady_since, step.speed)
            timed = watch.time(step.swing)
            builder.add(command, {STROBE_READING: seen, STOPWATCH_READING: timed})
            commands.append(operator.command(seen, timed))
        return builder.build(complete=True)

    def _settings(self) -> Mapping[str, Mapping[str, Any]]:
        return {
            'jigsaw': {'amplitude': self.plant.amplitude},
            'pendulum': {'plant': asdict(self.plant)},
            'strobe': {'seed': self.seed, 'instrument': asdict(self.instruments.strobe)},
            'stopwatch': {
                'seed': self.seed,
                'swings': self.protocol.swings,
                'instrument': asdict(self.instruments.stopwatch),
            },
        }
