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
    standing, falling = ((3, 197), (40, 150), (77, 31), (60, 150)), ((0, 0), (5, 20), (149, 199), (100, 198))
    for i, j in standing:
        slow = theory.slow_frequency_exact(Plant(damping=1.0, amplitude=amplitudes[i]), speeds[j])
        assert found.stable[i, j]
        assert found.half_trace[i, j] == pytest.approx(math.cos(2 * math.pi * slow / speeds[j]), abs=1e-10)
    for i, j in falling:
        growth = theory.growth_rate(Plant(damping=1.0, amplitude=amplitudes[i]), speeds[j])
        assert not found.stable[i, j]
        expected = math.cosh(2 * math.pi * (growth + 0.5) / speeds[j])
        assert abs(found.half_trace[i, j]) == pytest.approx(expected, rel=1e-10)


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
