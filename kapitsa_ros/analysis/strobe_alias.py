"""What a speed read off the strobe's dial is worth: its error, and whether the marks stood at a wrong ratio."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING

from kapitsa_ros.instruments.dial_search import standing_ratios
from kapitsa_ros.instruments.strobe_images import faintest

if TYPE_CHECKING:
    from kapitsa_ros.instruments.strobe_settings import StrobeSettings

NEAR = 0.03
"""Relative distance from the speed asked, or from a simple ratio of it, within which a reading is taken for that."""
_NONE = Fraction(1)


def dial_sigma(strobe: StrobeSettings) -> float:
    """Return the standard uncertainty of a speed read off the dial and halved, rad/s: an unseen drift, a graduation."""
    return math.hypot(strobe.drift_limit / math.sqrt(3.0), 0.5 * strobe.dial_resolution / math.sqrt(12.0))


def find_alias(reading: float, speed_asked: float | None, strobe: StrobeSettings, dial_u: float = 0.0) -> Fraction:
    """Return the ratio of a reading to the speed of the shaft, since the operator knows roughly the speed asked.

    The person stops at a flash rate of (p/q)·ω and halves; where that is not twice ω the reading is p/(2q) times the
    speed. A reading that fits no such ratio, or of a speed that nobody asked for, is left as it is.

    Parameters
    ----------
    reading, speed_asked
        rad/s.
    strobe
        Lamp and eye.
    dial_u
        Standard uncertainty of the dial's calibration, relative.

    """
    near = NEAR + 2.0 * dial_u
    if not speed_asked or abs(reading / speed_asked - 1.0) <= near:
        return _NONE
    ratios = [ratio / 2 for ratio in standing_ratios(0.5, 10.0, faintest(strobe)) if ratio != Fraction(2)]
    ratio = min(ratios, key=lambda ratio: abs(math.log(reading / (float(ratio) * speed_asked))))
    return ratio if abs(reading / float(ratio) / speed_asked - 1.0) <= near else _NONE
