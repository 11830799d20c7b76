"""The published numbers the physics is held against: test/physics/truth.json."""

import json
from pathlib import Path

from kapitsa_ros.physics.parameters import PlantParameters
from kapitsa_ros.units import RPM

ENTRIES = {entry['id']: entry for entry in json.loads(Path(__file__).with_name('truth.json').read_text('utf-8'))['truth']}


def plant_of(params):
    """Return the plant an entry speaks of."""
    names = {'L_m': 'length', 'lam_m': 'amplitude', 'c_per_s': 'damping', 'g': 'gravity', 'f': 'coulomb'}
    names |= {'D_m': 'clearance', 'e': 'restitution'}
    return PlantParameters(**{names[key]: value for key, value in params.items() if key in names})


def speed_of(params):
    """Return rad/s."""
    return params['rpm'] * RPM
