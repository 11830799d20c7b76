"""What a protocol promises: the interval of readings that are as the plant gives them, without their errors."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from kapitsa_ros.analysis.critical_speed import Ruler, direct_fit, evidence_of, uncertainty_budget
from kapitsa_ros.analysis.strobe_alias import dial_sigma
from kapitsa_ros.analysis.timing_row import TimingRow
from kapitsa_ros.instruments.perfect_timing import timed_period

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.analysis.critical_speed import Evidence
    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
    from kapitsa_ros.physics.plant import Plant


def press_variance(stopwatch: StopwatchSettings) -> float:
    """Return that of a display, s², by two presses and the last digit."""
    return 2.0 * stopwatch.reaction_jitter**2 + stopwatch.display_resolution**2 / 12.0


@dataclass(frozen=True, kw_only=True)
class Promise:
    """What timings of a plant at some speeds would tell, as these instruments err."""

    plant: Plant
    instruments: Instruments
    assumptions: Assumptions
    release: float
    """θ, rad."""
    speeds: Sequence[float]
    """ω, rad/s."""
    swings: int
    """Of a timing."""
    repeats: int
    """Timings at each speed."""

    @cached_property
    def half_width_percent(self) -> float:
        """Half the width of the 95 % interval, per cent of the critical speed."""
        found = direct_fit(self._evidence, self._ruler, self.plant.gravity, self.assumptions)
        low, high = found.interval
        return math.inf if low is None or high is None else 50.0 * (high - low) / found.omega_crit

    @property
    def limited_by(self) -> str:
        """What contributes most to the uncertainty."""
        budget = uncertainty_budget(self._evidence, self._ruler, self.plant.gravity, self.assumptions)
        return max(budget.rows, key=lambda row: row.contribution).name

    @property
    def _ruler(self) -> Ruler:
        return Ruler(amplitude=self.plant.amplitude)

    @property
    def _evidence(self) -> Evidence:
        sigma = math.sqrt(press_variance(self.instruments.stopwatch) / self.repeats) / self.swings
        return evidence_of(
            [
                TimingRow(
                    kind='timed',
                    speed=speed,
                    speed_sigma=dial_sigma(self.instruments.strobe),
                    period=timed_period(self.plant, speed, self.release, self.swings),
                    period_sigma=sigma,
                    release=self.release,
                    swings=self.swings,
                )
                for speed in self.speeds
            ]
        )
