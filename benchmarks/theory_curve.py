"""Theory at 10⁵ speeds in one call, against a loop over the functions of one speed."""

from __future__ import annotations

import numpy as np
from measure import Claim, cpu

import kapitsa_ros as kr
from kapitsa_ros.physics import theory

PLANT = kr.Plant(damping=0.2)
SPEEDS = kr.rpm(np.linspace(500.0, 5000.0, 100_000))


def loop() -> np.ndarray:
    """Ask for one speed after the other."""
    rows = [
        (
            theory.mathieu_a(PLANT, speed),
            theory.is_stable(PLANT, speed),
            theory.slow_frequency_exact(PLANT, speed),
            theory.slow_frequency_averaged(PLANT, speed),
            theory.growth_rate(PLANT, speed),
        )
        for speed in SPEEDS.tolist()
    ]
    return np.array(rows, dtype=float)


def main() -> None:
    """Measure and print."""
    ours_s, peer_s = cpu(lambda: kr.theory(PLANT, speed=SPEEDS), loop)
    slow = loop()[:, 2]
    Claim(
        work='theory, a speed of 10^5',
        peer='a loop over the functions of one speed',
        target='>= 3',
        ours_s=ours_s / SPEEDS.size,
        peer_s=peer_s / SPEEDS.size,
        ours_error=float(np.nanmax(np.abs(kr.theory(PLANT, speed=SPEEDS).slow / slow - 1.0))),
        peer_error=None,
        unit='of the slow frequency, against the loop',
    ).show()


if __name__ == '__main__':
    main()
