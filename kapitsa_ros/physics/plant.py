"""What the plant is made of."""

from __future__ import annotations

from dataclasses import dataclass

from kapitsa_ros.physics.errors import ParameterError
from kapitsa_ros.schema import ParameterSet, describe, quantity

G_STANDARD = 9.80665


@dataclass(frozen=True, kw_only=True)
class Plant(ParameterSet):
    """The rod, its pivot and the stroke that shakes it (SI units).

    The equation of motion is θ″ = k (g + y″) sin θ − c θ′ − f sgn θ′ with k = κ·3/(2L) (report, eq. 1 with friction of
    eqs. 17 and 19). Length and stroke are those of Table 1, 9.75 in and 0.5 in. The clearance grows by `wear` with the
    energy that impacts take of the relative motion, ½(1 − e²)v² per mass.

    Raises
    ------
    ParameterError
        A value is no finite number or out of its range.

    """

    error = ParameterError

    length: float = quantity(0.24765, 'm', 0.0, 1e3, above=True, symbol='L', description='length of the uniform rod')
    amplitude: float = quantity(
        0.0127, 'm', 0.0, 1e2, above=True, symbol='λ', description='amplitude of the pivot, half its stroke'
    )
    gravity: float = quantity(
        G_STANDARD, 'm/s²', 0.0, 1e3, above=True, symbol='g', description='acceleration of gravity'
    )
    damping: float = quantity(
        0.0, '1/s', 0.0, 1e6, symbol='c', loss='viscous', description='viscous friction, 3μ/(mL²)'
    )
    coulomb: float = quantity(
        0.0, 'rad/s²', 0.0, 1e6, symbol='f', loss='other', description='Coulomb friction, 3φ/(mL²)'
    )
    clearance: float = quantity(
        0.0, 'm', 0.0, 1.0, symbol='D', loss='other', description='diametral play of the pivot hole'
    )
    restitution: float = quantity(0.0, '', 0.0, 1.0, symbol='e', description='restitution of impacts within the play')
    inertia_factor: float = quantity(
        1.0, '', 0.0, 1e3, above=True, symbol='κ', description='k = κ·3/(2L); 1 is the ideal rod'
    )
    wear: float = quantity(
        0.0, 'm·kg/J', 0.0, 1.0, description='growth of the clearance with the energy that impacts lose'
    )
    failure_clearance: float = quantity(
        0.01, 'm', 0.0, 1.0, above=True, description='play at which the hole has worn through and the rod comes off'
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.clearance >= self.failure_clearance:
            raise ParameterError(
                f'clearance is {self.clearance} m: it must be below failure_clearance ({self.failure_clearance} m)',
            )

    @property
    def k(self) -> float:
        """m·l_c/I, 1/m: κ·3/(2L)."""
        return self.inertia_factor * 1.5 / self.length

    @property
    def conservative(self) -> bool:
        """Whether nothing takes energy from the motion: no friction, and no play in which impacts could."""
        return all(getattr(self, item.name) == 0 for item in describe(Plant) if item.loss)

    @property
    def linearly_damped(self) -> bool:
        """Whether nothing but viscous damping, if any, takes energy: the equation of small swings is linear."""
        return all(getattr(self, item.name) == 0 for item in describe(Plant) if item.loss == 'other')

    def without_losses(self) -> Plant:
        """Return the same rod without friction and play."""
        return self.replaced({item.name: 0.0 for item in describe(Plant) if item.loss})
