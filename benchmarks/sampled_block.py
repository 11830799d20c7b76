"""A block of 100 ms at 1 kHz through `Pendulum.advance`, as the graph runs it: against 200 µs, and its error.

The peer is SciPy's LSODA over the same samples through a cubic Hermite spline of the pivot's acceleration.
"""

from __future__ import annotations

import math

import numpy as np
from measure import Claim, cpu
from pendulum import ANGLE, PLANT, SPEED, slope
from scipy.integrate import odeint, solve_ivp
from scipy.interpolate import CubicSpline

from kapitsa_ros.physics.jigsaw import Jigsaw
from kapitsa_ros.physics.jigsaw_parameters import JigsawParameters
from kapitsa_ros.physics.pendulum import Pendulum

BLOCKS = 100


def main() -> None:
    """Measure and print."""
    jigsaw = Jigsaw(amplitude=PLANT.amplitude, parameters=JigsawParameters(spin_up=1e5))
    jigsaw.advance(SPEED, 4 * math.pi / SPEED, 1)
    blocks = [jigsaw.advance(SPEED, 0.1, 100) for _ in range(BLOCKS)]

    def ours() -> float:
        pendulum = Pendulum(PLANT)
        pendulum.hold(ANGLE)
        pendulum.release()
        return float([pendulum.advance(block) for block in blocks][-1].position[-1])

    def spline() -> float:
        state = (ANGLE, 0.0)
        times = np.linspace(0.0, 0.1, 101)
        for block in blocks:
            load = CubicSpline(times, block.acceleration)

            def pull(t: float, y: list[float], load: CubicSpline = load) -> tuple[float, float]:
                return y[1], PLANT.k * (PLANT.gravity + load(t)) * math.sin(y[0])

            state = odeint(pull, state, times, tfirst=True, rtol=1e-9, atol=1e-11)[-1]
        return float(state[0])

    truth = solve_ivp(slope, (0, 0.1 * BLOCKS), (ANGLE, 0.0), method='DOP853', rtol=2.3e-14, atol=1e-16).y[0, -1]
    ours_s, spline_s = cpu(ours, spline)
    Claim(
        work='a block of 100 ms at 1 kHz, sampled pivot (error after 10 s)',
        peer='odeint through a cubic spline of y″, rtol 1e-9',
        target='ours < 200 µs, error < 1e-9 rad',
        ours_s=ours_s / BLOCKS,
        peer_s=spline_s / BLOCKS,
        ours_error=float(abs(ours() - truth)),
        peer_error=float(abs(spline() - truth)),
    ).show()


if __name__ == '__main__':
    main()
