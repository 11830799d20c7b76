"""The averaged equation (report, eqs. 8 and 15), for any inertia: with k = 3/(2L) they read as printed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeVar

from kapitsa_ros.physics.plant import Plant

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


_Speeds = TypeVar('_Speeds', 'float', 'NDArray[np.float64]')


def omega_crit_averaged(plant: Plant) -> float:
    """Return the critical speed, rad/s: √(2g/k)/λ, which is (2/λ)√(gL/3) for the rod (report, eq. 8)."""
    return math.sqrt(2.0 * plant.gravity / plant.k) / plant.amplitude


def plant_of_threshold(threshold: float, amplitude: float, gravity: float, damping: float = 0.0) -> Plant:
    """Return a plant with this averaged critical speed: the inverse of `omega_crit_averaged`.

    Its length is nominal, the inertia factor makes up for it: nothing but k tells rods apart.

    Parameters
    ----------
    threshold
        √(2g/k)/λ, rad/s.
    amplitude
        λ, m.
    gravity
        g, m/s².
    damping
        c, 1/s. Ω hangs on c² alone; a fit that strays below c = 0 on its way is not stopped there.

    """
    k = 2.0 * gravity / (amplitude * threshold) ** 2
    return Plant(length=1.5, amplitude=amplitude, gravity=gravity, damping=abs(damping), inertia_factor=k)


def k_of_slow_frequency(speed: _Speeds, slow: _Speeds, amplitude: float, gravity: float) -> _Speeds:
    """Return k, 1/m, of the rod that swings with Ω = `slow` at ω = `speed` (rad/s), by Ω² = k²λ²ω²/2 − kg."""
    stroke = (amplitude * speed) ** 2
    root: _Speeds = (gravity**2 + 2.0 * stroke * slow**2) ** 0.5
    return (gravity + root) / stroke


def period_steepness(plant: Plant, speed: NDArray[np.float64], slow: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return −d ln T/dω = k²λ²ω/(2Ω²), s/rad: by which share a period is shorter at a higher speed.

    Parameters
    ----------
    plant
        Its friction does not enter.
    speed, slow
        ω and Ω, rad/s, of one shape.

    """
    return (plant.k * plant.amplitude) ** 2 * speed / (2.0 * slow**2)


def slow_squared_averaged(plant: Plant, speed: _Speeds) -> _Speeds:
    """Return Ω² = k²λ²ω²/2 − kg, (rad/s)², negative below the critical speed; of one speed ω (rad/s) or of an array."""
    return 0.5 * (plant.k * plant.amplitude * speed) ** 2 - plant.k * plant.gravity


def slow_frequency_averaged(plant: Plant, speed: float) -> float | None:
    """Return Ω, rad/s: Ω² = k²λ²ω²/2 − kg, which is 9λ²ω²/(8L²) − 3g/(2L) for the rod (report, eq. 15).

    Parameters
    ----------
    plant
        Its friction does not enter.
    speed
        ω, rad/s.

    Returns
    -------
    float or None
        None below the critical speed.

    """
    square = slow_squared_averaged(plant, speed)
    return math.sqrt(square) if square >= 0 else None
