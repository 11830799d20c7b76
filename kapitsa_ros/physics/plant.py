"""What the plant is made of, and the presets that are shipped."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import yaml

from kapitsa_ros.physics.errors import ParameterError
from kapitsa_ros.resources import resource_path

if TYPE_CHECKING:
    from collections.abc import Mapping

PRESETS = ('ideal', 'bearing', 'as_built_1997')
G_STANDARD = 9.80665


@dataclass(frozen=True, kw_only=True)
class Plant:
    """The rod, its pivot and the stroke that shakes it (SI units).

    The equation of motion is θ″ = k (g + y″) sin θ − c θ′ − f sgn θ′ with k = κ·3/(2L) (report, eq. 1 with friction of
    eqs. 17 and 19).

    Raises
    ------
    ParameterError
        A value is not finite or out of its range.

    """

    length: float = 0.24765
    """L, m: a uniform rod (Table 1: 9.75 in)."""
    amplitude: float = 0.0127
    """λ, m: half the stroke of the pivot (Table 1: 0.5 in)."""
    gravity: float = G_STANDARD
    """g, m/s²."""
    damping: float = 0.0
    """c = 3μ/(mL²), 1/s."""
    coulomb: float = 0.0
    """f = 3φ/(mL²), rad/s²."""
    clearance: float = 0.0
    """D, m: diametral play between hole and bolt."""
    restitution: float = 0.0
    """e, of the impacts within the play."""
    inertia_factor: float = 1.0
    """κ: 1 for the ideal rod."""
    wear: float = 0.0
    """Growth of the clearance with the energy the impacts lose, m per J/kg of the relative motion (½(1 − e²)v²)."""
    failure_clearance: float = 0.01
    """m: play at which the hole has worn through and the rod comes off, as in 1997."""

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if not math.isfinite(value):
                raise ParameterError(f'{name} is {value}: give a finite number')
        for name in ('length', 'amplitude', 'gravity', 'inertia_factor', 'failure_clearance'):
            if getattr(self, name) <= 0:
                raise ParameterError(f'{name} is {getattr(self, name)}: it must be above 0')
        for name in ('damping', 'coulomb', 'clearance', 'wear'):
            if getattr(self, name) < 0:
                raise ParameterError(f'{name} is {getattr(self, name)}: it must not be negative')
        if self.restitution > 1 or self.restitution < 0:
            raise ParameterError(f'restitution is {self.restitution}: it must lie in [0, 1]')
        if self.clearance >= self.failure_clearance:
            raise ParameterError(
                f'clearance is {self.clearance} m: it must be below failure_clearance ({self.failure_clearance} m)',
            )

    @property
    def k(self) -> float:
        """m·l_c/I, 1/m: κ·3/(2L)."""
        return self.inertia_factor * 1.5 / self.length


def load_preset(name: str, overrides: Mapping[str, float] | None = None) -> Plant:
    """Read a preset from config/presets and replace the given parameters.

    Raises
    ------
    ParameterError
        There is no such preset, or a value is out of its range.

    """
    if name not in PRESETS:
        raise ParameterError(f'unknown preset {name!r}: choose one of {", ".join(PRESETS)}')
    document = yaml.safe_load(resource_path('config', 'presets', f'{name}.yaml').read_text(encoding='utf-8'))
    return Plant(**{**document['/**']['ros__parameters'], **(overrides or {})})
