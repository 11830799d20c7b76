"""The procedure of 1997: raise the flash rate until the marks stand still and are doubled, then halve."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING

from kapitsa_ros.instruments.strobe_images import faintest, number_of_images

if TYPE_CHECKING:
    import numpy as np

    from kapitsa_ros.instruments.strobe_settings import StrobeSettings

_LOWEST = 0.5  # flash rate over shaft speed
_SWEEPS = 10  # a person who has found nothing by then gives up


@dataclass(frozen=True, kw_only=True)
class SearchResult:
    """Where the person stopped turning the dial."""

    ratio: Fraction
    """Flash rate over shaft speed at which the marks stood; 2 unless the person was fooled."""
    residue: float
    """Drift left over, rad/s of the shaft, not noticed."""
    seconds: float
    """What the procedure took."""

    def flash_rate(self, shaft_speed: float) -> float:
        """Return the flash rate left on the lamp, rad/s."""
        return float(self.ratio) * (shaft_speed + self.residue)


def standing_ratios(low: float, high: float, phases: int) -> list[Fraction]:
    """List the ratios p/q in (low, high] at which at most `phases` images stand still, ascending."""
    found = {
        Fraction(p, q) for p in range(1, phases + 1) for q in range(max(1, math.ceil(p / high)), math.ceil(p / low))
    }
    return sorted(ratio for ratio in found if low < ratio <= high)


@lru_cache(maxsize=64)
def _ratios_by_value(high: float, phases: int) -> tuple[tuple[float, Fraction], ...]:
    """Return the ratios above 1/2, the lowest flash rate anybody begins at, each with its value."""
    ratios = standing_ratios(_LOWEST, high, phases) if high > _LOWEST else []
    return tuple((float(ratio), ratio) for ratio in ratios)


def raise_until_doubled(shaft_speed: float, settings: StrobeSettings, rng: np.random.Generator) -> SearchResult | None:
    """Turn the dial up from a guess of the shaft's speed until the marks stand still and look doubled.

    The phase at which the flashes happen to catch the shaft is random at each ratio, and so is the drift left over.
    Three or four flash phases can look doubled, which stops the person too early, and two can look single, which sends
    them on.

    Parameters
    ----------
    shaft_speed
        True speed, rad/s.
    settings
        Lamp and eye.
    rng
        Stream of this strobe.

    Returns
    -------
    SearchResult or None
        None where the lamp ends before the marks ever looked doubled.

    """
    end = settings.dial_end / shaft_speed
    seconds = 0.0
    for _ in range(_SWEEPS):
        start = max(_LOWEST, 1.0 + settings.guess_error * rng.standard_normal())
        for value, ratio in _ratios_by_value(end, faintest(settings)):
            if value <= start:
                continue
            seconds += settings.look_time
            residue = settings.drift_limit * rng.uniform(-1.0, 1.0)
            if _looks_doubled(ratio, 2.0 * math.pi * rng.random(), residue, settings):
                seconds += settings.sweep_time * (value - start)
                return SearchResult(ratio=ratio, residue=residue, seconds=seconds)
        seconds += settings.sweep_time * max(end - start, 0.0)
    return None


def _looks_doubled(ratio: Fraction, phase: float, residue: float, settings: StrobeSettings) -> bool:
    """Tell whether there are two images from the beginning of the look to its end, while their phase creeps."""
    later = phase - residue * settings.look_time
    return all(number_of_images(ratio.numerator, at, settings.mark_width) == 2 for at in (phase, later))


def read_dial(flash_rate: float, settings: StrobeSettings) -> float:
    """Read the dial and halve: the shaft's speed as it is written down, rad/s."""
    return graduation(flash_rate, settings) / 2.0


def graduation(flash_rate: float, settings: StrobeSettings) -> float:
    """Return what the dial says, to its nearest graduation, rad/s of flashes."""
    shown = flash_rate * (1.0 + settings.dial_error)
    if settings.dial_resolution > 0.0:
        shown = round(shown / settings.dial_resolution) * settings.dial_resolution
    return shown
