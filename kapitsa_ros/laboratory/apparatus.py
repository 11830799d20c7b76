"""Jigsaw, pendulum and what eyes see of them: the same whoever experiments, so that many experiments share them."""

from __future__ import annotations

from copy import copy
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from kapitsa_ros.configuration.step_parameters import StepParameters
from kapitsa_ros.instruments.steady_speed_detector import SteadySpeedDetector
from kapitsa_ros.instruments.swing_observer import SwingObserver
from kapitsa_ros.network.step_clock import StepClock
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.physics.jigsaw import Jigsaw
from kapitsa_ros.physics.pendulum import Pendulum

if TYPE_CHECKING:
    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.instruments.swing_observer import SwingSight
    from kapitsa_ros.operator.command import Command
    from kapitsa_ros.physics.plant import Plant

STEPS = StepParameters()
"""Those that the nodes have by default."""
MOST_KEPT = 8192
"""Steps, some 4 kB each."""
_CLOCK, _SAMPLES = StepClock(STEPS.step_ns), STEPS.samples


class _Machines(NamedTuple):
    """All that one step leaves to the next."""

    jigsaw: Jigsaw
    pendulum: Pendulum
    shaft: SteadySpeedDetector
    eye: SwingObserver

    def copied(self) -> _Machines:
        """Return machines that go on from here by themselves."""
        return _Machines(copy(self.jigsaw), copy(self.pendulum), copy(self.shaft), copy(self.eye))


class _Kept:
    """How many steps are kept."""

    def __init__(self) -> None:
        self.count = 0


class ApparatusStart:
    """The apparatus before a run, or after a step that followed on certain commands; what follows is computed once.

    Experiments with the same plant and the same eyes differ by chance alone: by when a reading is taken, and so the rod
    let go, and by when the thumb presses. Between these the motion is the same, and is not computed again.
    """

    __slots__ = ('_kept', '_machines', '_next', '_number')

    def __init__(self, number: int, machines: _Machines, kept: _Kept) -> None:
        self._number = number
        self._machines = machines
        self._kept = kept
        self._next: dict[Command, ApparatusStep] = {}

    def after(self, command: Command) -> ApparatusStep:
        """Return the next step, carried out under a command."""
        found = self._next.get(command)
        if found is None:
            found = self._carry_out(command)
            if self._kept.count < MOST_KEPT:
                self._next[command] = found
                self._kept.count += 1
        return found

    def _carry_out(self, command: Command) -> ApparatusStep:
        machines = self._machines.copied()
        start = _CLOCK.start(StepId(1, self._number + 1))
        pivot = machines.jigsaw.advance(command.speed, _CLOCK.step, _SAMPLES)
        if command.hold is None:
            machines.pendulum.release()
        else:
            machines.pendulum.hold(command.hold)
        machines.shaft.follow(start, pivot)
        swing = machines.eye.observe(start, machines.pendulum.advance(pivot))
        return ApparatusStep(self._number + 1, machines, self._kept, swing)


class ApparatusStep(ApparatusStart):
    """The apparatus after a step, and what was seen in it."""

    __slots__ = ('speed', 'steady_since', 'swing')

    def __init__(self, number: int, machines: _Machines, kept: _Kept, swing: SwingSight) -> None:
        super().__init__(number, machines, kept)
        self.steady_since, self.speed = machines.shaft.steady_since, machines.shaft.speed
        """What the shaft is seen to do, as `SteadySpeedDetector` has it."""
        self.swing = swing
        """What is seen of the pendulum."""


def apparatus(plant: Plant, instruments: Instruments) -> ApparatusStart:
    """Return what is there before the first step of a run."""
    return _apparatus(plant, instruments.strobe.drift_limit, instruments.stopwatch.persistence)


@lru_cache(maxsize=1)  # a campaign goes from point to point
def _apparatus(plant: Plant, drift_limit: float, persistence: float) -> ApparatusStart:
    machines = _Machines(
        Jigsaw(amplitude=plant.amplitude), Pendulum(plant), SteadySpeedDetector(drift_limit), SwingObserver(persistence)
    )
    return ApparatusStart(-1, machines, _Kept())
