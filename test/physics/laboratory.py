"""A jigsaw already at speed with a pendulum on it, block by block, as the network runs them."""

import math

import numpy as np
from hypothesis import strategies as st

from kapitsa_ros.physics.jigsaw import Jigsaw
from kapitsa_ros.physics.jigsaw_parameters import JigsawParameters
from kapitsa_ros.physics.pendulum import Pendulum
from kapitsa_ros.physics.plant import Plant


def jigsaw_at(speed, *, amplitude=0.0127, rod_ratio=0.0):
    """Return a jigsaw that turns at `speed`, rad/s, and stands at the bottom of its stroke."""
    jigsaw = Jigsaw(amplitude=amplitude, parameters=JigsawParameters(rod_ratio=rod_ratio, spin_up=1e5, max_speed=1e4))
    jigsaw.advance(speed, 4 * math.pi / speed, 8)
    return jigsaw


def swing(plant, speed, release, *, blocks, duration=0.1, count=100, linear=False):
    """Release at rest at the bottom of the stroke; return (times, θ, θ′) at all samples and the pendulum."""
    jigsaw = jigsaw_at(speed, amplitude=plant.amplitude)
    pendulum = Pendulum(plant, linear=linear)
    pendulum.hold(release)
    pendulum.release()
    motions = [pendulum.advance(jigsaw.advance(speed, duration, count)) for _ in range(blocks)]
    angle = np.concatenate([motions[0].position[:1]] + [motion.position[1:] for motion in motions])
    rate = np.concatenate([motions[0].rate[:1]] + [motion.rate[1:] for motion in motions])
    return np.arange(angle.size) * (duration / count), angle, rate, pendulum


def rods(*, slenderness, length, **others):
    """Draw plants whose stroke is a share of their rod's length."""
    return st.builds(
        lambda share, size, **rest: Plant(length=size, amplitude=share * size, **rest),
        slenderness,
        length,
        **others,
    )
