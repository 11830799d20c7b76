"""How the jigsaw turns and shakes, besides its stroke, which is the plant's."""

from __future__ import annotations

import math
from dataclasses import dataclass

from kapitsa_ros.physics.errors import ParameterError
from kapitsa_ros.schema import ParameterSet, quantity

MAX_SPEED = 5000 * 2.0 * math.pi / 60
"""rad/s: 5000 strokes a minute, the fastest by default."""


@dataclass(frozen=True, kw_only=True)
class JigsawParameters(ParameterSet):
    """Crank and shaft of the jigsaw (SI units).

    A `rod_ratio` of 0 is a Scotch yoke, whose stroke is the pure cosine y = −λ cos φ of the report.

    Raises
    ------
    ParameterError
        A value is no finite number or out of its range.

    """

    error = ParameterError

    rod_ratio: float = quantity(
        0.0, '', 0.0, 1e6, symbol='ρ', description='connecting rod over crank radius, above 1; 0: pure cosine'
    )
    phase: float = quantity(
        0.0, 'rad', -10.0, 10.0, symbol='p', description='of the pivot when a run begins; 0: bottom of the stroke'
    )
    spin_up: float = quantity(200.0, 'rad/s²', 0.1, 1e5, description='angular acceleration of the shaft')
    max_speed: float = quantity(MAX_SPEED, 'rad/s', 1.0, 1e4, description='fastest the shaft can turn')

    def __post_init__(self) -> None:
        super().__post_init__()
        if 0 < self.rod_ratio <= 1:
            raise ParameterError(f'rod_ratio is {self.rod_ratio}: it must be above 1, or 0 for a pure cosine')
