"""Compile every kernel now, so that no run waits for it."""

from __future__ import annotations

from kapitsa_ros.physics.parameters import PlantParameters
from kapitsa_ros.physics.pivot import Jigsaw
from kapitsa_ros.physics.plant import Pendulum
from kapitsa_ros.physics.theory.floquet import growth_rate
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear


def warm() -> None:
    """Compile the kernels and leave them in numba's cache on disk."""
    plant = PlantParameters()
    pendulum = Pendulum(plant)
    pendulum.advance(Jigsaw(amplitude=plant.amplitude).advance(100.0, 0.1, 100))
    growth_rate(plant, 200.0)
    slow_frequency_nonlinear(plant, 250.0, 0.1)


if __name__ == '__main__':
    warm()
