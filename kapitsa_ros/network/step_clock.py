"""Simulated time of the steps.

Each run takes place on a day of its own: run n begins at n times 86,400 s. So no stamp is zero, stamps grow from run to
run, and the stamps of one run depend on nothing that happened in another.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kapitsa_ros.network.step_id import StepId

SECOND = 1_000_000_000
DAY = 86_400 * SECOND


@dataclass(frozen=True, slots=True)
class StepClock:
    """Maps step numbers to simulated time."""

    step_ns: int
    """Length of a communication step, ns."""

    def start_ns(self, step_id: StepId) -> int:
        """Return the simulated time at which a step begins, ns."""
        return step_id.run * DAY + step_id.step * self.step_ns

    def start(self, step_id: StepId) -> float:
        """Return the seconds from the start of the run to the start of the step."""
        return step_id.step * self.step_ns / SECOND

    @property
    def step(self) -> float:
        """Length of a communication step, s."""
        return self.step_ns / SECOND


def seconds_of_run(stamp_ns: int, step_id: StepId) -> float:
    """Return the seconds from the start of a run to a stamp."""
    return (stamp_ns - step_id.run * DAY) / SECOND
