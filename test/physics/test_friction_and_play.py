import math
from dataclasses import replace

import numpy as np
import pytest
from laboratory import jigsaw_at, swing
from scipy.integrate import solve_ivp
from truth import ENTRIES, plant_of, speed_of

from kapitsa_ros.physics import theory
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.kernels import layout
from kapitsa_ros.physics.pendulum import Pendulum
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.units import RPM

SPEED = 2500 * RPM
TURN = 2 * math.pi / SPEED


@pytest.mark.parametrize('name', ['buzz_ratio_1640', 'buzz_ratio_2500'])
@pytest.mark.parametrize('coulomb', [0.5, 2.0])
def test_it_buzzes_off_upright_at_the_published_angle(name, coulomb):
    entry = ENTRIES[name]
    plant = replace(plant_of(entry['params']), coulomb=coulomb)
    speed = speed_of(entry['params'])
    stuck_zone = coulomb / (plant.k * (plant.gravity + plant.amplitude * speed**2))
    _, angle, _, pendulum = swing(plant, speed, 15 * stuck_zone, blocks=2000, duration=2 * math.pi / speed, count=40)
    assert not pendulum.fell
    assert angle[-1] / stuck_zone == pytest.approx(entry['value'], rel=1e-4)


def test_inside_the_stuck_zone_it_does_not_move():
    plant = Plant(coulomb=5.0)
    zone = ENTRIES['theta_s_2500_f5']['value']
    _, angle, rate, pendulum = swing(plant, SPEED, 0.999 * zone, blocks=20)
    assert pendulum.stuck
    assert np.all(angle == angle[0])
    assert not rate.any()
    _, angle, _, _ = swing(plant, SPEED, 1.001 * zone, blocks=20)
    assert np.ptp(angle) > 0


@pytest.mark.parametrize('release', [0.003, 0.05, 0.3])
def test_friction_never_adds_energy_on_a_resting_pivot(release):
    """On a pivot at rest the energy ½θ′² + kg cos θ falls whatever the friction."""
    plant = Plant(coulomb=0.2, damping=0.05)
    jigsaw, pendulum = jigsaw_at(100.0), Pendulum(plant, stop=7.0)
    jigsaw.advance(0.0, 0.1, 1)
    pendulum.hold(math.pi - release)
    pendulum.release()
    motions = [pendulum.advance(jigsaw.advance(0.0, 0.1, 100)) for _ in range(250)]
    energy = np.concatenate([0.5 * m.rate**2 + plant.k * plant.gravity * np.cos(m.position) for m in motions])
    assert np.all(np.diff(energy) <= 1e-13)
    assert pendulum.stuck


def test_a_swing_on_a_resting_pivot_loses_the_friction_work_exactly():
    """From one turning point to the next the energy lost is f times the way gone."""
    plant = Plant(coulomb=0.4)
    jigsaw, pendulum = jigsaw_at(100.0), Pendulum(plant, stop=7.0)
    jigsaw.advance(0.0, 0.1, 1)
    pendulum.hold(math.pi - 0.5)
    pendulum.release()
    motions = [pendulum.advance(jigsaw.advance(0.0, 0.1, 100)) for _ in range(250)]
    angle = np.concatenate([m.position for m in motions])
    rate = np.concatenate([m.rate for m in motions])
    way = np.sum(np.abs(np.diff(angle)))
    # Between samples that straddle a turning point a little of the way is missing: at most the parabola's height.
    energy = 0.5 * rate**2 + plant.k * plant.gravity * np.cos(angle)
    assert (energy[0] - energy[-1]) / plant.coulomb == pytest.approx(way, abs=2e-4)
    assert pendulum.stuck


def struck(plant, y, wall, *, pressing):
    """Return the state after an impact, and whether the hole now rests on the pin."""
    angle, rate, _, strike = y
    rebound = plant.restitution * strike
    rests = pressing and abs(rebound) < 1e-6
    if rests:
        rebound = 0.0
    return [angle, rate - (strike + rebound) * plant.k * math.sin(angle), wall * 0.5 * plant.clearance, -rebound], rests


def impacts_by_scipy(plant, speed, release, end):
    """Return θ of a rod in play, from SciPy's event location: contact, flight and impacts told apart by hand."""

    def shake(t):
        return plant.gravity + plant.amplitude * speed**2 * math.cos(speed * t)

    def in_contact(t, y):
        return [y[1], plant.k * shake(t) * math.sin(y[0]) - plant.damping * y[1], 0.0, 0.0]

    def in_flight(t, y):
        return [y[1], -plant.damping * y[1], y[3], -shake(t)]

    def room(_, y):
        return 0.5 * plant.clearance - abs(y[2])

    def lift(t, _):
        return shake(t)

    room.terminal, room.direction = True, -1
    lift.terminal = True
    t, y, side = 0.0, [release, 0.0, -0.5 * plant.clearance, 0.0], -1.0
    while t < end:
        flow, events = (in_contact, lift) if side else (in_flight, room)
        part = solve_ivp(flow, (t, end), y, method='DOP853', rtol=1e-12, atol=1e-14, events=events, max_step=1e-3)
        t, y = part.t[-1], list(part.y[:, -1])
        if t < end and side:
            side, y[3] = 0.0, 0.0
        elif t < end:
            wall = math.copysign(1.0, y[2])
            y, rests = struck(plant, y, wall, pressing=wall * shake(t + 1e-10) < 0)
            side = wall if rests else 0.0
    return y[0]


@pytest.mark.parametrize(('restitution', 'within'), [(0.0, 1e-10), (0.3, 1e-6), (0.6, 1e-6)])
def test_impacts_agree_with_event_location(restitution, within):
    plant = Plant(clearance=5e-4, restitution=restitution)
    _, angle, _, _ = swing(plant, SPEED, 0.1, blocks=3)
    assert angle[-1] == pytest.approx(impacts_by_scipy(plant, SPEED, 0.1, 0.3), abs=within)


OTHER_RODS = [
    (Plant(length=0.1, amplitude=0.02, clearance=3e-4, damping=8.0), 1500 * RPM),
    (Plant(length=0.6, amplitude=0.02, gravity=3.7, inertia_factor=0.8, clearance=1e-3), 2000 * RPM),
]


@pytest.mark.parametrize(('plant', 'speed'), OTHER_RODS)
def test_impacts_of_other_rods_agree_with_event_location(plant, speed):
    _, angle, _, _ = swing(plant, speed, 0.1, blocks=2)
    assert angle[-1] == pytest.approx(impacts_by_scipy(plant, speed, 0.1, 0.2), abs=1e-10)


@pytest.mark.parametrize(('plant', 'speed'), OTHER_RODS)
def test_the_effective_amplitude_of_other_rods_under_play_is_first_order(plant, speed):
    """From the map at the bottoms of the stroke; halve the play and what theory misses falls by more than that."""
    missed = []
    for share in (1.0, 0.5):
        rod = replace(plant, clearance=share * plant.clearance, damping=0.0)
        turn = 2 * math.pi / speed
        _, angle, rate, _ = swing(rod, speed, 0.002, blocks=100, duration=turn, count=24)
        orbit = np.stack((angle[480::24], rate[480::24]))
        turned = np.linalg.eigvals(orbit[:, 1:] @ np.linalg.pinv(orbit[:, :-1]))
        slow = abs(np.angle(turned[0])) / turn
        missed.append(abs(theory.slow_frequency_with_play(rod, speed) / slow - 1))
        assert missed[-1] < 0.1 * abs(theory.slow_frequency_exact(rod, speed) / slow - 1)
    assert missed[1] < 0.6 * missed[0]


def test_play_at_zero_clearance_equals_no_play():
    _, none, _, _ = swing(Plant(), SPEED, 0.1, blocks=10)
    gaps = (1e-7, 1e-8)
    off = [np.abs(swing(Plant(clearance=gap), SPEED, 0.1, blocks=10)[1] - none).max() for gap in gaps]
    assert off[0] < 1e-4
    assert off[1] / off[0] == pytest.approx(0.1, rel=0.05)


@pytest.mark.parametrize('restitution', [0.0, 0.3, 0.9, 1.0])
def test_the_hole_stays_on_the_pin(restitution):
    plant = Plant(clearance=5e-4, restitution=restitution, coulomb=0.3)
    jigsaw, pendulum = jigsaw_at(SPEED), Pendulum(plant)
    pendulum.hold(0.05)
    pendulum.release()
    for _ in range(400):
        pendulum.advance(jigsaw.advance(SPEED, 0.001, 4))
        assert abs(pendulum._state[layout.GAP]) <= 2.5e-4 * (1 + 1e-12)
    assert (pendulum.impact_energy > 1e-9) == (restitution < 1)


def test_wear_grows_the_clearance_with_the_energy_of_the_impacts_until_the_rod_comes_off():
    plant = Plant(clearance=2e-4, wear=2e-5, failure_clearance=4e-4)
    _, _, _, pendulum = swing(plant, SPEED, 0.1, blocks=3)
    assert pendulum.clearance == pytest.approx(2e-4 + 2e-5 * pendulum.impact_energy, rel=1e-12)
    assert not pendulum.failed
    _, angle, _, pendulum = swing(plant, SPEED, 0.1, blocks=100)
    assert pendulum.failed
    assert pendulum.fell
    assert angle[-1] == angle[-2]
    with pytest.raises(PhysicsError, match='worn'):
        pendulum.hold(0.1)


def test_small_swings_with_friction_free_pivot_follow_linear_theory():
    """From turn to turn a linear swing obeys x₊ + x₋ = 2 cos(ΩT) x, whatever its phase."""
    _, angle, _, _ = swing(Plant(), SPEED, 1e-3, blocks=100, linear=True)
    turn = 24  # ms, exactly
    before, now, after = angle[: -2 * turn], angle[turn:-turn], angle[2 * turn :]
    half_trace = (before + after) @ now / (2 * now @ now)
    slow = theory.slow_frequency_exact(Plant(), SPEED)
    assert half_trace == pytest.approx(math.cos(slow * TURN), abs=1e-9)
    np.testing.assert_allclose(before + after, 2 * half_trace * now, rtol=0, atol=1e-11)


def test_linear_and_nonlinear_part_with_the_cube_of_the_amplitude():
    apart = []
    for release in (0.02, 0.04):
        _, full, _, _ = swing(Plant(), SPEED, release, blocks=10)
        _, line, _, _ = swing(Plant(), SPEED, release, blocks=10, linear=True)
        apart.append(np.abs(full - line).max())
    assert math.log2(apart[1] / apart[0]) == pytest.approx(3, abs=0.02)
