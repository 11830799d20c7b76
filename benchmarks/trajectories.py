"""10,000 trajectories of 6 s: the cost of one among many against a single one's, and the memory they take.

The many run on all cores; both costs are CPU time. Memory is the growth of the largest resident set.
"""

from __future__ import annotations

import json
import resource

import numpy as np
from measure import Claim, cpu
from pendulum import PLANT, SPEED

from kapitsa_ros.physics.batch import simulate_batch
from kapitsa_ros.physics.release import Release

DURATION = 6.0
MANY = 10_000


def peak() -> float:
    """Return the largest resident set so far, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main() -> None:
    """Measure and print."""
    angles = np.linspace(0.01, 0.3, MANY)

    def many(count: int) -> np.ndarray:
        return simulate_batch(PLANT, speed=SPEED, angle=angles[:: MANY // count], duration=DURATION).angle

    def single() -> float:
        return float(Release(plant=PLANT, speed=SPEED, angle=angles[0]).sampled(DURATION, 1 / DURATION).angle[-1])

    many(100)
    few = peak()
    ends = many(MANY)
    print(json.dumps({'work': 'memory of 10,000 trajectories over that of 100', 'megabytes': peak() - few}), flush=True)
    many_s, single_s = cpu(lambda: many(MANY), lambda: [single() for _ in range(200)])
    Claim(
        work='one of 10,000 trajectories of 6 s',
        peer='ours, a single one',
        target='>= 1',
        ours_s=many_s / MANY,
        peer_s=single_s / 200,
        ours_error=abs(float(ends[0]) - single()),
        peer_error=0.0,
    ).show()


if __name__ == '__main__':
    main()
