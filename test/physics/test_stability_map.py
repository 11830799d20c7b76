import math

import numpy as np
import pytest

from kapitsa_ros.physics import theory
from kapitsa_ros.physics.errors import ParameterError
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.units import RPM


@pytest.mark.parametrize('damping', [0.0, 2.0, 40.0])
def test_the_map_agrees_with_the_exponents(damping):
    plant = Plant(damping=damping)
    speeds, ratios = np.linspace(60, 6000, 37) * RPM, np.linspace(0.001, 0.9, 23)
    found = theory.stability_map(plant, speeds, ratios * plant.length)
    for i, ratio in enumerate(ratios):
        rod = Plant(damping=damping, amplitude=ratio * plant.length)
        for j, speed in enumerate(speeds):
            growth = theory.growth_rate(rod, speed)
            half_trace = found.half_trace[i, j]
            assert found.stable[i, j] == (growth <= 0)
            if abs(half_trace) > 1 + 1e-9:
                expected = math.acosh(abs(half_trace)) * speed / (2 * math.pi) - damping / 2
                assert growth == pytest.approx(expected, rel=1e-7, abs=1e-6 * speed)


def test_the_map_at_1e_10():
    """Against the monodromy matrix at points off its own nodes."""
    plant = Plant(damping=1.0)
    speeds = np.linspace(300, 5000, 200) * RPM
    amplitudes = np.linspace(0.002, 0.12, 150)
    found = theory.stability_map(plant, speeds, amplitudes)
    for i, j in ((0, 0), (3, 197), (77, 31), (149, 0), (149, 199), (100, 100)):
        rod = Plant(damping=1.0, amplitude=amplitudes[i])
        slow = theory.slow_frequency_exact(rod, speeds[j])
        if found.stable[i, j] and slow:
            assert found.half_trace[i, j] == pytest.approx(math.cos(2 * math.pi * slow / speeds[j]), abs=1e-10)


@pytest.mark.parametrize(
    ('speeds', 'amplitudes'),
    [
        ([0.0, 1.0], [0.01]),
        ([2.0, 1.0], [0.01]),
        ([math.nan], [0.01]),
        ([1.0], [-0.01]),
        ([[1.0]], [0.01]),
        ([], [0.01]),
    ],
)
def test_bad_axes(speeds, amplitudes):
    with pytest.raises(ParameterError, match='ascending'):
        theory.stability_map(Plant(), speeds, amplitudes)
