"""Jigsaw and pendulum as a URDF, for viewers."""

from __future__ import annotations

from string import Template
from typing import TYPE_CHECKING

from kapitsa_ros.physics.jigsaw_parameters import MAX_SPEED
from kapitsa_ros.resources import resource_path

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant

MASS = 0.1
"""kg of each moving link. The report gives none, and the motion depends on none."""


def urdf(plant: Plant) -> str:
    """Return the URDF of a plant: joints `pivot` (m) and `pendulum` (rad), a frame `tip` at the end of the rod.

    The rod is uniform: `inertia_factor`, which is fitted and no property of a rod, is not in it; nor is play.
    """
    length, width = plant.length, plant.length / 12
    thickness = width / 4
    blade = length / 3 + 2 * plant.amplitude
    body = length / 2
    numbers = {
        'mass': MASS,
        'length': length,
        'half_length': length / 2,
        'width': width,
        'thickness': thickness,
        'bolt': 3 * width,
        'mark': width / 3,
        'mark_z': length - width,
        'rod_inertia': MASS * length**2 / 12,
        'axial_inertia': MASS * (width**2 + thickness**2) / 12,
        'amplitude': plant.amplitude,
        'pivot_speed': plant.amplitude * MAX_SPEED,
        'blade': blade,
        'half_blade': blade / 2,
        'blade_inertia': MASS * blade**2 / 12,
        'body_x': body * 1.5,
        'body_y': body / 2,
        'body_z': -length / 3 - body / 4,
    }
    template = resource_path('config', 'viewers', 'kapitsa.urdf.template').read_text(encoding='utf-8')
    return Template(template).substitute({name: f'{value:.9g}' for name, value in numbers.items()})
