"""60 s at 2500 RPM with Coulomb friction to 1e-9 rad: ours against SciPy's event location, and against ours without.

The swing dies within 6 s, so the error is the larger of those at 1 s and at 60 s. The reference is SciPy at its
tightest.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from measure import Claim, cpu
from pendulum import ANGLE, DURATION, PLANT, SHAKE, SPEED, WEIGHT
from scipy.integrate import solve_ivp

from kapitsa_ros.physics.release import Release

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.physics.plant import Plant

COULOMB = 1.0
RUBBING = replace(PLANT, coulomb=COULOMB)
WORK = '60 s at 2500 RPM, Coulomb friction'


def ours(plant: Plant = RUBBING, duration: float = DURATION) -> float:
    """Return θ in the end."""
    return float(Release(plant=plant, speed=SPEED, angle=ANGLE).sampled(duration, 1.0 / duration).angle[-1])


def with_events(tolerance: float, duration: float = DURATION) -> float:
    """Return θ in the end, integrated from one change of sliding to the next; a stuck rod waits for its slip."""
    t, theta = 0.0, ANGLE
    while t < duration:
        pull = _pull(t, theta)
        if abs(pull) <= COULOMB:
            t = min(_slip(t, theta), duration)
            pull = _pull(t, theta)
        t, theta = _slide((t, duration), theta, math.copysign(COULOMB, pull), tolerance)
    return theta


def _pull(t: float, theta: float) -> float:
    return (WEIGHT + SHAKE * math.cos(SPEED * t)) * math.sin(theta)


def _slip(t: float, theta: float) -> float:
    """Return when the pull next exceeds friction: the load has to reach ±f/sin θ."""
    limit = COULOMB / abs(math.sin(theta)) if theta else math.inf
    phases = [
        sign * math.acos(level)
        for level in ((limit - WEIGHT) / SHAKE, (-limit - WEIGHT) / SHAKE)
        if abs(level) <= 1.0
        for sign in (1, -1)
    ]
    if not phases:
        return math.inf
    now = SPEED * t
    rising = [now + (phase - now) % (2 * math.pi) for phase in phases]
    return min(
        (at / SPEED for at in rising if abs(_pull(at / SPEED + 1e-9, theta)) > COULOMB),
        default=math.inf,
    )


def _slide(span: tuple[float, float], theta: float, friction: float, tolerance: float) -> tuple[float, float]:
    def slope(time: float, y: list[float]) -> tuple[float, float]:
        return y[1], (WEIGHT + SHAKE * math.cos(SPEED * time)) * math.sin(y[0]) - friction

    def rest(_: float, y: list[float]) -> float:
        return y[1]

    rest.terminal = True
    rest.direction = -friction
    part = solve_ivp(slope, span, (theta, 0.0), method='DOP853', rtol=tolerance, atol=1e-3 * tolerance, events=rest)
    return float(part.t[-1]), float(part.y[0, -1])


def error(work: Callable[[float], float]) -> float:
    """Return the larger of a solver's errors at 1 s and at 60 s."""
    return max(abs(work(end) - with_events(1e-13, end)) for end in (1.0, DURATION))


def main() -> None:
    """Measure and print."""
    tolerance = 1e-11
    ours_s, peer_s = cpu(ours, lambda: with_events(tolerance))
    ours_error = error(lambda end: ours(duration=end))
    Claim(
        work=WORK,
        peer=f'solve_ivp DOP853 with events, rtol {tolerance:g}',
        target='>= 100',
        ours_s=ours_s,
        peer_s=peer_s,
        ours_error=ours_error,
        peer_error=error(lambda end: with_events(tolerance, end)),
    ).show()
    ours_s, smooth_s = cpu(ours, lambda: ours(PLANT))
    Claim(
        work=WORK,
        peer='ours without friction',
        target='>= 0.5',
        ours_s=ours_s,
        peer_s=smooth_s,
        ours_error=ours_error,
        peer_error=None,
    ).show()


if __name__ == '__main__':
    main()
