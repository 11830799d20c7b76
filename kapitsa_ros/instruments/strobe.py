"""The strobe lamp in the hands of a person."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kapitsa_ros.instruments.dial_search import SearchResult, raise_until_doubled, read_dial
from kapitsa_ros.instruments.steady_speed_detector import SteadySpeedDetector

if TYPE_CHECKING:
    import numpy as np

    from kapitsa_ros.instruments.strobe_settings import StrobeSettings
    from kapitsa_ros.physics.sampled_motion import SampledMotion


@dataclass(frozen=True, kw_only=True)
class StrobeReading:
    """What was read off the dial and halved."""

    time: float
    """When, in seconds of the run."""
    speed: float
    """Of the shaft, as the person believes, rad/s."""


class Strobe:
    """Waits until the shaft is steady, carries out the procedure of 1997, and reads the dial once for each speed.

    Parameters
    ----------
    settings
        Lamp, dial and eye.
    rng
        Stream of this instrument in this run.

    """

    def __init__(self, settings: StrobeSettings, rng: np.random.Generator) -> None:
        self._settings = settings
        self._rng = rng
        self._shaft = SteadySpeedDetector(settings.drift_limit)
        self._since: float | None = None
        self._finding: SearchResult | None = None

    def observe(self, start: float, pivot: SampledMotion) -> StrobeReading | None:
        """Watch the mark for one communication step.

        Parameters
        ----------
        start
            Seconds of the run at the block's first sample; blocks join without gaps.
        pivot
            Motion of the pivot, on which the mark rides.

        Returns
        -------
        StrobeReading or None
            A reading, in the step in which it is taken.

        """
        self._shaft.follow(start, pivot)
        return self.search(start + pivot.duration, self._shaft.steady_since, self._shaft.speed)

    def search(self, now: float, since: float | None, speed: float) -> StrobeReading | None:
        """Do what `observe` does, by what the shaft is seen to do.

        Parameters
        ----------
        now
            Seconds of the run at the end of the step.
        since, speed
            As `SteadySpeedDetector` has them then.

        """
        if since is not None and since != self._since:
            self._finding = raise_until_doubled(speed, self._settings, self._rng)
        self._since = since
        if since is None or self._finding is None or now < since + self._finding.seconds:
            return None
        finding, self._finding = self._finding, None
        return StrobeReading(time=since + finding.seconds, speed=read_dial(finding.flash_rate(speed), self._settings))
