"""When a thumb presses the stopwatch, and what the display then shows."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

    from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings


@dataclass(frozen=True, kw_only=True)
class PressErrors:
    """The errors of one timing."""

    start_delay: float
    """From the passage that starts the timing to the press, s."""
    stop_delay: float
    """From the passage that ends it to the press, s."""
    miscount: int
    """Swings let pass too many (1) or too few (-1)."""


def draw_press_errors(settings: StopwatchSettings, rng: np.random.Generator) -> PressErrors:
    """Draw the errors of one timing.

    A single press is late by N(reaction_time, reaction_jitter²) (AJP 87, 110 (2019): 0.11 s and 0.07 s); early ones
    come of it too. The last swing ends in a rhythm that is known by then, so that the delay may be partly anticipated.
    """
    start = settings.reaction_time + settings.reaction_jitter * rng.standard_normal()
    stop = settings.reaction_time * (1.0 - settings.anticipation) + settings.reaction_jitter * rng.standard_normal()
    luck = rng.random()
    miscount = 0 if luck >= settings.miscount_probability else (1 if 2.0 * luck < settings.miscount_probability else -1)
    return PressErrors(start_delay=start, stop_delay=stop, miscount=miscount)


def display(elapsed: float, settings: StopwatchSettings) -> float:
    """Return what the display shows after `elapsed` seconds.

    A digital stopwatch counts the ticks since its divider was reset by the start press, so it shows completed ticks
    only: it truncates, and reads half a digit short on average.
    """
    shown = elapsed * (1.0 + settings.rate_error)
    if settings.display_resolution > 0.0:
        shown = math.floor(shown / settings.display_resolution) * settings.display_resolution
    return max(shown, 0.0)
