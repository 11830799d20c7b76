"""What a ruler says of the stroke: an instrument like the others, read once an experiment."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kapitsa_ros.instruments.random_streams import random_stream

if TYPE_CHECKING:
    from kapitsa_ros.network.run import Run

RULER_SIGMA = 0.125e-3
"""m; of λ, half of what a steel ruler leaves open of the stroke between its two ends (0.25 mm)."""

_ERRORS = ('dial_resolution', 'drift_limit', 'reaction_jitter', 'display_resolution')
"""Of strobe and stopwatch: where all are 0 the set of instruments is a perfect one, and its ruler is, too."""


@dataclass(frozen=True, kw_only=True)
class Ruler:
    """What a ruler says of the stroke."""

    amplitude: float
    """λ, m."""
    sigma: float = RULER_SIGMA
    """Standard uncertainty, m."""


def ruler_of(*runs: Run) -> Ruler:
    """Return what the ruler said of the stroke in the experiments that runs of one plant belong to.

    It was read once in each, and errs by its standard uncertainty, by the seed of the experiment; of several the mean
    counts. What the drivers of a real rig, who have no seed, say of the stroke is a ruler's word already.

    Raises
    ------
    RunError
        The settings do not describe a plant.

    """
    read = {run.settings.get('strobe', {}).get('seed'): _amplitude_of(run) for run in runs}
    return Ruler(amplitude=math.fsum(read.values()) / len(read), sigma=RULER_SIGMA / math.sqrt(len(read)))


def _amplitude_of(run: Run) -> float:
    amplitude = run.plant.amplitude
    seed = run.settings.get('strobe', {}).get('seed')
    instruments = {
        name: value
        for role in ('strobe', 'stopwatch')
        for name, value in run.settings.get(role, {}).get('instrument', {}).items()
    }
    if seed is None or not any(instruments.get(name) for name in _ERRORS):
        return amplitude
    return amplitude + RULER_SIGMA * float(random_stream(seed, 'ruler', 0).standard_normal())
