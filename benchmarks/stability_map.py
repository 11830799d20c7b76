"""The stability map: 10⁶ points of (ω, λ), damped, at 1e-10: ours against RK4 of the monodromy and scipy.special.

The peers are measured on fewer points and scaled; RK4 runs vectorised over its points, in blocks that fit the cache.
"""

from __future__ import annotations

import math

import numpy as np
from measure import Claim, cpu
from scipy.special import mathieu_a, mathieu_b

from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory import stability_map
from kapitsa_ros.physics.theory.mathieu import half_trace
from kapitsa_ros.units import RPM

PLANT = Plant(damping=1.0)
SPEEDS = np.linspace(500.0, 5000.0, 1000) * RPM
AMPLITUDES = np.linspace(0.02, 0.5, 1000) * PLANT.length
FEW = 2000
STEPS = 800


def companion(speed: np.ndarray, amplitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a and q of the undamped companion."""
    return -(4 * PLANT.k * PLANT.gravity + PLANT.damping**2) / speed**2, 2 * PLANT.k * amplitude


def runge_kutta(a: np.ndarray, q: np.ndarray, steps: int) -> np.ndarray:
    """Return half the trace by the classical method: both columns of the matrix at once."""
    state = np.zeros((2, 2, a.size))
    state[0, 0] = state[1, 1] = 1.0
    h = math.pi / steps

    def slope(stiffness: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.stack((y[1], -stiffness * y[0]))

    for i in range(steps):
        first, middle, last = (a - 2 * q * math.cos(2 * z) for z in (i * h, (i + 0.5) * h, (i + 1) * h))
        k1 = slope(first, state)
        k2 = slope(middle, state + 0.5 * h * k1)
        k3 = slope(middle, state + 0.5 * h * k2)
        k4 = slope(last, state + h * k3)
        state += h / 6 * (k1 + 2 * (k2 + k3) + k4)
    return 0.5 * (state[0, 0] + state[1, 1])


def main() -> None:
    """Measure and print."""
    points = SPEEDS.size * AMPLITUDES.size
    pick = np.random.default_rng(1).integers(0, 1000, (2, FEW))
    a, q = companion(SPEEDS[pick[1]], AMPLITUDES[pick[0]])
    truth = np.array([half_trace(np.array([one]), np.array([other]))[0, 0] for one, other in zip(a, q, strict=True)])
    scale = np.maximum(1.0, np.abs(truth))

    found = stability_map(PLANT, SPEEDS, AMPLITUDES)
    ours_s, rk4_s, special_s = cpu(
        lambda: stability_map(PLANT, SPEEDS, AMPLITUDES),
        lambda: runge_kutta(a, q, STEPS),
        lambda: (mathieu_a(0, q) < a) & (a < mathieu_b(1, q)),
    )
    ours_s /= points
    ours_error = float(np.max(np.abs(found.half_trace[pick[0], pick[1]] - truth) / scale))
    Claim(
        work='stability map, a point of 10^6',
        peer=f'RK4 of the monodromy matrix, {STEPS} steps',
        target='>= 1000',
        ours_s=ours_s,
        peer_s=rk4_s / FEW,
        ours_error=ours_error,
        peer_error=float(np.max(np.abs(runge_kutta(a, q, STEPS) - truth) / scale)),
        unit='of the half-trace',
    ).show()
    Claim(
        work='stability map, a point of 10^6',
        peer='scipy.special mathieu_a and mathieu_b (undamped)',
        target='>= 30',
        ours_s=ours_s,
        peer_s=special_s / FEW,
        ours_error=ours_error,
        peer_error=None,
        unit='of the half-trace',
    ).show()


if __name__ == '__main__':
    main()
