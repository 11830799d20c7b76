"""The pendulum of 1997 as its peers take it, and the reference all errors are against."""

from __future__ import annotations

import math

import heyoka as hy

from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.release import Release
from kapitsa_ros.units import RPM

PLANT = Plant()
SPEED = 2500 * RPM
ANGLE = 0.12
DURATION = 60.0
WEIGHT = PLANT.k * PLANT.gravity
SHAKE = PLANT.k * PLANT.amplitude * SPEED**2


def slope(t: float, y: list[float]) -> tuple[float, float]:
    """Return (θ′, θ″): the cheapest Python there is for it."""
    return y[1], (WEIGHT + SHAKE * math.cos(SPEED * t)) * math.sin(y[0])


def ours() -> float:
    """Return θ after 60 s: 60 × 1000 / 60 000 samples are not kept, only the last."""
    return float(Release(plant=PLANT, speed=SPEED, angle=ANGLE).sampled(DURATION, 1.0 / DURATION).angle[-1])


def taylor(tolerance: float) -> hy.taylor_adaptive:
    """Return heyoka's integrator of the same equation."""
    theta, rate = hy.make_vars('theta', 'rate')
    load = WEIGHT + SHAKE * hy.cos(SPEED * hy.time)
    return hy.taylor_adaptive([(theta, rate), (rate, load * hy.sin(theta))], [ANGLE, 0.0], tol=tolerance)


def run(integrator: hy.taylor_adaptive) -> float:
    """Start the integrator again and return θ after 60 s."""
    integrator.time = 0.0
    integrator.state[:] = [ANGLE, 0.0]
    integrator.propagate_until(DURATION)
    return float(integrator.state[0])


def reference() -> float:
    """Return θ after 60 s from heyoka at its tightest, which shares no code with ours."""
    return run(taylor(1e-18))
