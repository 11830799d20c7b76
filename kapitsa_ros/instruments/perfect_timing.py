"""The period a perfect stopwatch would show, for causes that theory has no closed form for."""

from __future__ import annotations

import math

import numpy as np

from kapitsa_ros.instruments.stopwatch import Stopwatch, StopwatchReading
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.physics.jigsaw import crank
from kapitsa_ros.physics.pendulum import Pendulum
from kapitsa_ros.physics.plant import Plant  # noqa: TC001
from kapitsa_ros.physics.sampled_motion import SampledMotion

RELEASE = 0.12
"""rad; the swing of the report's Figure 4."""
SWINGS = 3

_COUNT, _PERIOD = 200, 1e-3  # samples a block, s
_LONGEST = 60.0  # s


def timed_period(plant: Plant, speed: float, release: float = RELEASE, swings: int = SWINGS) -> float:
    """Let the rod go at the bottom of the stroke and time it without error.

    Returns
    -------
    float
        Mean period of the swings, s; nan where the rod fell or came to rest before they were over.

    """
    reading = _watched(plant, speed, release, swings)
    return reading.displayed / swings if reading is not None and reading.kind == 'timed' else math.nan


def swings_seen(plant: Plant, speed: float, release: float, most: int) -> int:
    """Return how many full swings can be timed, up to `most`, before the rod comes to rest; 0 where it falls."""
    reading = _watched(plant, speed, release, most)
    return reading.swings if reading is not None and reading.kind != 'fell' else 0


def _watched(plant: Plant, speed: float, release: float, swings: int) -> StopwatchReading | None:
    pendulum = Pendulum(plant)
    watch = Stopwatch(StopwatchSettings(), swings, np.random.default_rng(0))  # a perfect thumb: chance plays no part
    pendulum.hold(release)
    for block in range(int(_LONGEST / (_COUNT * _PERIOD))):
        start = block * _COUNT * _PERIOD
        reading = watch.observe(start, pendulum.advance(_cosine(plant.amplitude, speed, start)))
        pendulum.release()
        if reading is not None:
            return reading
    return None


def _cosine(amplitude: float, speed: float, start: float) -> SampledMotion:
    height, slope, curvature = crank(speed * (start + np.arange(_COUNT + 1, dtype=np.float64) * _PERIOD), 0.0)
    return SampledMotion(
        period=_PERIOD,
        position=amplitude * height,
        rate=amplitude * speed * slope,
        acceleration=amplitude * speed**2 * curvature,
    )
