import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from kapitsa_ros.physics.errors import ParameterError, PhysicsError
from kapitsa_ros.physics.flexible_rod import BendingMode, coupling, simulate_flexible
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.release import Release
from kapitsa_ros.physics.run_summary import summarise_run
from kapitsa_ros.units import RPM

PLANT = Plant()
RELEASE = Release(plant=PLANT, speed=2500 * RPM, angle=0.1)
ROOT = 3.9266023120479190  # of tan λ = tanh λ


def mode(x):
    return math.sin(ROOT * x) / math.sin(ROOT) + math.sinh(ROOT * x) / math.sinh(ROOT)


def test_the_mode_is_normalised_orthogonal_to_rotation_and_coupled_by_its_mean():
    assert quad(lambda x: mode(x) ** 2, 0, 1)[0] == pytest.approx(1.0, rel=1e-12)
    assert quad(lambda x: x * mode(x), 0, 1)[0] == pytest.approx(0.0, abs=1e-13)
    assert quad(mode, 0, 1)[0] == pytest.approx(coupling(), rel=1e-12)


def test_a_stiff_rod_is_the_rigid_one_in_the_limit():
    rigid = RELEASE.sampled(1.0)
    apart = [
        np.abs(simulate_flexible(RELEASE, BendingMode(frequency=one), 1.0).angle - rigid.angle).max()
        for one in (8e3, 16e3)
    ]
    assert apart[1] < 1e-4
    assert apart[0] / apart[1] == pytest.approx(4.0, rel=0.02)


def test_it_solves_lagranges_equations():
    """SciPy integrates the Lagrangian as it stands, its derivatives by differences."""
    bending = BendingMode(frequency=900.0, damping=0.02)
    lever, speed = 0.5 * PLANT.length, RELEASE.speed
    inertia = lever / PLANT.k

    def energies(t, theta, eta, theta_rate, eta_rate):
        load = PLANT.gravity + PLANT.amplitude * speed**2 * math.cos(speed * t)
        kinetic = 0.5 * (inertia + eta**2) * theta_rate**2 + 0.5 * eta_rate**2
        height = lever * math.cos(theta) - coupling() * eta * math.sin(theta)
        return kinetic, load * height + 0.5 * (bending.frequency * eta) ** 2

    def slope(t, y):
        theta, eta, momentum, eta_rate = y
        theta_rate = momentum / (inertia + eta**2)

        def lagrangian(angle, deflection):
            kinetic, potential = energies(t, angle, deflection, theta_rate, eta_rate)
            return kinetic - potential

        step = 1e-20j

        def part(angle, deflection):
            load = PLANT.gravity + PLANT.amplitude * speed**2 * math.cos(speed * t)
            height = lever * np.cos(angle) - coupling() * deflection * np.sin(angle)
            potential = load * height + 0.5 * (bending.frequency * deflection) ** 2
            return (0.5 * deflection**2 * theta_rate**2 - potential).imag / 1e-20

        friction = 2 * bending.damping * bending.frequency * eta_rate
        return [theta_rate, eta_rate, part(theta + step, eta + 0j), part(theta + 0j, eta + step) - friction]

    expected = solve_ivp(slope, (0, 1), [0.1, 0, 0, 0], method='DOP853', rtol=1e-12, atol=1e-15).y[:, -1]
    found = simulate_flexible(RELEASE, bending, 1.0)
    assert found.angle[-1] == pytest.approx(expected[0], abs=1e-10)
    assert found.deflection[-1] == pytest.approx(expected[1], abs=1e-12)


def test_energy_is_conserved_without_drive():
    falling = Release(plant=PLANT, speed=1e-9, angle=0.1)
    run = simulate_flexible(falling, BendingMode(frequency=300.0), 0.4, 4000.0)
    lever = 0.5 * PLANT.length
    kinetic = 0.5 * (lever / PLANT.k + run.deflection**2) * run.rate**2 + 0.5 * run.deflection_rate**2
    height = lever * np.cos(run.angle) - coupling() * run.deflection * np.sin(run.angle)
    energy = kinetic + PLANT.gravity * height + 0.5 * (300.0 * run.deflection) ** 2
    assert np.ptp(run.angle) > 0.5
    assert np.ptp(energy) < 1e-12 * energy[0]


@pytest.mark.parametrize(('frequency', 'damping'), [(0.0, 0.0), (math.nan, 0.0), (100.0, -0.1)])
def test_bad_mode(frequency, damping):
    with pytest.raises(ParameterError, match='bending'):
        BendingMode(frequency=frequency, damping=damping)


@pytest.mark.parametrize('wrong', [{'coulomb': 1.0}, {'clearance': 1e-4}])
def test_what_a_bending_rod_has_not(wrong):
    release = Release(plant=Plant(**wrong), speed=200.0, angle=0.1)
    with pytest.raises(ParameterError, match='bending rod'):
        simulate_flexible(release, BendingMode(frequency=500.0), 1.0)


def test_what_swings_it_too_wildly_is_refused():
    """Near resonance with the drive shorter steps do; a short rod that whips round defeats the shortest."""
    run = simulate_flexible(RELEASE, BendingMode(frequency=45 * 2 * math.pi, damping=0.01), 2.0)
    assert np.abs(run.deflection).max() > 0.01
    whip = Plant(length=0.01, amplitude=0.3)
    with pytest.raises(PhysicsError, match='too wildly'):
        simulate_flexible(Release(plant=whip, speed=300.0, angle=1.0), BendingMode(frequency=300.0), 2.0, 1.0)


def test_an_overdamped_mode_creeps():
    """With ζ ≫ 1 the mode yields like a dashpot: the rod is the rigid one."""
    rigid = RELEASE.sampled(0.2)
    creeping = simulate_flexible(RELEASE, BendingMode(frequency=900.0, damping=200.0), 0.2)
    np.testing.assert_allclose(creeping.angle, rigid.angle, rtol=0, atol=1e-3)


def test_slow_motion_tends_to_the_rigid_rods():
    rigid = summarise_run(RELEASE, 5.0).frequency
    apart = [summarise_run(RELEASE, 5.0, BendingMode(frequency=one)).frequency - rigid for one in (3e3, 6e3)]
    assert apart[0] / apart[1] == pytest.approx(4.0, rel=0.05)
    assert abs(apart[1]) < 1e-3 * rigid
