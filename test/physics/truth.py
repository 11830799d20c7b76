"""The published numbers the physics is held against: test/physics/truth.json."""

import json
import math
from pathlib import Path

from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.units import RPM

_DOCUMENT = json.loads(Path(__file__).with_name('truth.json').read_text('utf-8'))
ENTRIES = {entry['id']: entry for entry in _DOCUMENT['truth']}


def plant_of(params):
    """Return the plant an entry speaks of."""
    names = {
        'L_m': 'length',
        'lam_m': 'amplitude',
        'c_per_s': 'damping',
        'g': 'gravity',
        'f': 'coulomb',
        'inertia_factor': 'inertia_factor',
    }
    names |= {'D_m': 'clearance', 'e': 'restitution'}
    return Plant(**{names[key]: value for key, value in params.items() if key in names})


def speed_of(params):
    """Return rad/s."""
    return params['rpm'] * RPM


def matching_digits(value, entry):
    """Print and return how many digits of a published value come out; of a published 0, those behind its point."""
    off = abs(value - entry['value']) / (abs(entry['value']) or 1.0)
    digits = -math.log10(max(off, 1e-16))
    value = float(value)
    print(f'{entry["id"]:20} {value!r:>23} agrees with {entry["value"]!r:>23} in {digits:4.1f} digits')  # noqa: T201
    return digits
