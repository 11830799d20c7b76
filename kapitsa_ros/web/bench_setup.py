"""What stands on a bench, and what the person before it is told of that."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.ruler import RULER_SIGMA
from kapitsa_ros.bench.bench_controls import FASTEST_PACE
from kapitsa_ros.bench.help_text import ideal_threshold
from kapitsa_ros.configuration.step_parameters import StepParameters

if TYPE_CHECKING:
    from pathlib import Path

    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.physics.plant import Plant

STEPS = StepParameters(step=0.2, in_flight=2)
"""Half of the messages, which are what a server's time goes into, and as much time in flight as by default."""


@dataclass(frozen=True, kw_only=True)
class BenchSetup:
    """A rig and its bench."""

    plant: Plant
    instruments: Instruments
    seed: int
    """Of all chance in the first rig."""
    rate: float
    """Simulated over wall seconds, at first."""
    bags: Path
    """Folder for the runs."""
    shown: Plant
    """What the person is told of the plant: it is drawn so, and its stroke is what the fit takes for known."""
    fastest_rate: float = FASTEST_PACE
    """To which the person may change the pace."""
    amplitude_sigma: float = RULER_SIGMA
    """Standard uncertainty of that stroke, m."""

    composed: bool = False
    """Whether the nodes share one process."""
    steps: StepParameters = STEPS

    def seed_of_rig(self, number: int) -> int:
        """Return the seed of a rig, from 1: its runs count anew, and are not to repeat the chance of those before."""
        if number == 1:
            return self.seed
        return int(np.random.SeedSequence(self.seed, spawn_key=(number,)).generate_state(1)[0])

    @property
    def threshold_rpm(self) -> float | None:
        """Critical speed of an ideal rod like this; None where the rod is sealed."""
        return ideal_threshold(self.plant) if self.shown is self.plant else None

    @property
    def scale(self) -> float:
        """By which heights are drawn larger than they are."""
        return self.shown.amplitude / self.plant.amplitude
