"""Compile every kernel now, so that no run waits for it."""

from __future__ import annotations

import numpy as np

from kapitsa_ros.physics import theory
from kapitsa_ros.physics.batch import simulate_batch
from kapitsa_ros.physics.flexible_rod import BendingMode, simulate_flexible
from kapitsa_ros.physics.jigsaw import Jigsaw
from kapitsa_ros.physics.kernels.slow_period import WORK_ROWS, period_errors, slow_periods, small_swings
from kapitsa_ros.physics.kernels.verlet import verlet
from kapitsa_ros.physics.pendulum import Pendulum
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.release import Release

SPEED = 250.0


def compile_kernels() -> None:
    """Compile the kernels and leave them in numba's cache on disk."""
    plant = Plant()
    Pendulum(plant).advance(Jigsaw(amplitude=plant.amplitude).advance(100.0, 0.1, 100))
    release = Release(plant=plant, speed=SPEED, angle=0.1)
    release.strobed(1)
    simulate_flexible(release, BendingMode(frequency=500.0), 0.01)
    simulate_batch(plant, speed=SPEED, angle=0.1, duration=0.01)
    theory.growth_rate(plant, SPEED)
    theory.floquet_curves(plant, np.array([SPEED]))
    theory.stability_map(plant, [SPEED], [plant.amplitude])
    one, row, work = np.ones(1), np.ones((1, 1)), np.empty((WORK_ROWS, 1))
    small_swings(one, one, one, row, 1.0, np.empty((1, 1)), work)
    slow_periods(one, one, one, one, row, one, one, 1.0, np.ones(2), 1.0, np.empty((1, 1)), np.empty((1, 1)), work)
    period_errors(one, one, one, one, row, np.empty((1, 1)))
    verlet(1.0, 1.0, SPEED, 0.0, 0.1, 1, np.empty((2, 2)))


if __name__ == '__main__':
    compile_kernels()
