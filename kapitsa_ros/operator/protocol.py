"""What the operator is to do: speeds, release angle, swings to time, repeats."""

from __future__ import annotations

import math
from dataclasses import dataclass

from kapitsa_ros.operator.errors import ProtocolError
from kapitsa_ros.schema import ParameterSet, quantity

MANUAL = 'manual'
"""In place of a protocol: the operator does what a person asks for."""


@dataclass(frozen=True, kw_only=True)
class Protocol(ParameterSet):
    """One run a speed, or one for all; at each, `repeats` timings of `swings` swings after a release from `release`.

    Raises
    ------
    ProtocolError
        A value is out of its range.

    """

    error = ProtocolError

    speeds: tuple[float, ...]
    """Forcing speeds, rad/s."""
    sweep: bool = False
    """Whether all speeds are set one after the other in one run."""
    release: float = quantity(
        0.12, 'rad', -math.pi / 2, math.pi / 2, description='angle from upright at which the pendulum is let go'
    )
    swings: int = quantity(3, '', 1, 1000, description='full swings timed after each release')
    repeats: int = quantity(1, '', 1, 1000, description='releases at each speed')

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.speeds or not all(math.isfinite(speed) and speed > 0 for speed in self.speeds):
            raise ProtocolError('speeds: give one or more positive speeds, as in [2240 rpm, 2640 rpm]')
        if not 0 < abs(self.release) < math.pi / 2:
            raise ProtocolError(f'release: {self.release} rad is not between 0 and a quarter turn')
        if not isinstance(self.sweep, bool):
            raise ProtocolError(f'sweep: {self.sweep!r} is neither true nor false')

    @property
    def runs(self) -> tuple[tuple[float, ...], ...]:
        """Speeds of each run, rad/s."""
        return (self.speeds,) if self.sweep else tuple((speed,) for speed in self.speeds)
