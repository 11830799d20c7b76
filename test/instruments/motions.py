"""Motions with known answers, cut into blocks as the graph delivers them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.sampled_motion import SampledMotion

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


def blocks(
    motion: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]],
    duration: float,
    *,
    start: float = 0.0,
    count: int = 100,
    period: float = 1e-3,
) -> Iterator[tuple[float, SampledMotion]]:
    for number in range(round(duration / (count * period))):
        begin = start + number * count * period
        times = begin + np.arange(count + 1) * period
        yield begin, SampledMotion(period, *motion(times))


def shaft(speed: float, phase: float = 0.0, rod_ratio: float = np.inf):
    """Return a cosine's motion (or a slider-crank's of unit amplitude): at phase 0 it is at the bottom."""

    def motion(times):
        phi = phase + speed * times
        y = -np.cos(phi)
        dy, ddy = speed * np.sin(phi), speed**2 * np.cos(phi)
        if np.isfinite(rod_ratio):
            root = np.sqrt(rod_ratio**2 - np.sin(phi) ** 2)
            y = y + root - rod_ratio
            half, cos2 = np.sin(2 * phi) / 2, np.cos(2 * phi)
            dy = dy - speed * half / root
            ddy = ddy - speed**2 * (cos2 / root + half**2 / root**3)
        return y, dy, ddy

    return motion


def swing(slow: float, forcing: float, angle: float, let_go: float, decay: float = 0.0):
    """Return a slow swing with the sidebands of its forcing, held at `angle` until `let_go`."""

    def motion(times):
        t = np.maximum(times - let_go, 0.0)
        lines = 0.0422313 * np.cos((forcing - slow) * t) + 0.0351415 * np.cos((forcing + slow) * t)
        value = angle * np.exp(-decay * t) * (np.cos(slow * t) - lines) / (1 - 0.0422313 - 0.0351415)
        moving = times > let_go
        return np.where(moving, value, angle), moving * 1.0, moving * 1.0

    return motion
