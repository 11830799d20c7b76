"""Figure 4: a time history of the angle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.physics.release import Release
from kapitsa_ros.reporting.figures.canvas import BLUE, blank
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from kapitsa_ros.physics.plant import Plant


def time_history(plant: Plant, speed: float, release: float = 0.12, duration: float = 5.0) -> Figure:
    """Draw θ(t) of a rod released at rest at the bottom of the stroke (speed in rad/s)."""
    motion = Release(plant=plant, speed=speed, angle=release).sampled(duration)
    title = f'Figure 4: time history of θ at {speed / RPM:.0f} RPM, released at {release:g} rad'
    return angle_history(motion.time, motion.angle, title)


def angle_history(time: NDArray[np.float64], angle: NDArray[np.float64], title: str) -> Figure:
    """Draw θ (rad) over time (s)."""
    figure = blank(title)
    (axes,) = figure.axes
    axes.plot(time, angle, color=BLUE, linewidth=0.7)
    axes.set(xlabel='t (s)', ylabel='θ (rad)', xlim=(0.0, time[-1]))
    return figure
