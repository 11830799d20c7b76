"""60 s at 2500 RPM, nonlinear, to 1e-8 rad: ours against SciPy, heyoka and MuJoCo.

Each peer runs at the loosest tolerance (a power of ten) that keeps 1e-8 rad, or as near as it gets.
"""

from __future__ import annotations

import math

import mujoco
from measure import Claim, cpu
from pendulum import ANGLE, DURATION, PLANT, SHAKE, SPEED, ours, reference, run, slope, taylor
from scipy.integrate import odeint, solve_ivp

WORK = '60 s at 2500 RPM, nonlinear'


def ivp(method: str, tolerance: float) -> float:
    """Return θ after 60 s from solve_ivp."""
    solution = solve_ivp(slope, (0, DURATION), (ANGLE, 0.0), method=method, rtol=tolerance, atol=0.1 * tolerance)
    return float(solution.y[0, -1])


def ode(tolerance: float) -> float:
    """Return θ after 60 s from odeint."""
    ends = odeint(slope, (ANGLE, 0.0), (0.0, DURATION), tfirst=True, rtol=tolerance, atol=0.1 * tolerance, mxstep=10**6)
    return float(ends[-1, 0])


def mujoco_model(step: float) -> mujoco.MjModel:
    """Return the rod on a hinge, mass 1 kg, integrated by Runge and Kutta's fourth order."""
    half, inertia = 0.5 * PLANT.length, PLANT.length**2 / 12.0
    return mujoco.MjModel.from_xml_string(f"""
        <mujoco><option timestep="{step!r}" integrator="RK4" gravity="0 0 -{PLANT.gravity!r}"/>
        <worldbody><body><joint type="hinge" axis="0 1 0"/>
        <inertial pos="0 0 {half!r}" mass="1" diaginertia="{inertia!r} {inertia!r} 1e-6"/>
        </body></worldbody></mujoco>""")


def shaken(model: mujoco.MjModel) -> float:
    """Return θ after 60 s; the pivot's acceleration acts through the passive callback, at every stage's own time."""
    data = mujoco.MjData(model)
    data.qpos[0] = ANGLE
    inertia = PLANT.length**2 / 3.0

    def shake(_: mujoco.MjModel, state: mujoco.MjData) -> None:
        state.qfrc_passive[0] += inertia * SHAKE * math.cos(SPEED * state.time) * math.sin(state.qpos[0])

    mujoco.set_mjcb_passive(shake)
    try:
        mujoco.mj_step(model, data, round(DURATION / model.opt.timestep))
    finally:
        mujoco.set_mjcb_passive(None)
    return float(data.qpos[0])


def main() -> None:
    """Measure and print."""
    truth = reference()
    heyoka = taylor(1e-12)
    model = mujoco_model(1.0 / 8192)
    peers = (
        ('solve_ivp DOP853, rtol 1e-11', '>= 200', lambda: ivp('DOP853', 1e-11)),
        ('solve_ivp LSODA, rtol 1e-11', '>= 100', lambda: ivp('LSODA', 1e-11)),
        ('odeint, rtol 1e-11', '>= 15', lambda: ode(1e-11)),
        ('heyoka, tolerance 1e-12', '>= 1.3', lambda: run(heyoka)),
        ('MuJoCo RK4, 1/8192 s', '', lambda: shaken(model)),
    )
    for name, target, work in peers:
        ours_s, peer_s = cpu(ours, work)
        Claim(
            work=WORK,
            peer=name,
            target=target,
            ours_s=ours_s,
            peer_s=peer_s,
            ours_error=abs(ours() - truth),
            peer_error=abs(work() - truth),
        ).show()


if __name__ == '__main__':
    main()
