from dataclasses import replace

import numpy as np
import pytest

from kapitsa_ros.analysis.critical_speed import Ruler, direct_fit, evidence_from_motion
from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.recorded_run import RecordedRun
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.network.run import Run
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.release import Release
from kapitsa_ros.physics.theory.floquet import omega_crit_exact, slow_frequency_exact
from kapitsa_ros.units import RPM

NOMINAL = Plant()


def recorded(plant, rpm, duration=6.0, held=0.5):
    motion = Release(plant=plant, speed=rpm * RPM, angle=0.12).sampled(duration, 1000.0)
    run = Run(number=1, settings={}, speed_asked=rpm * RPM, release=0.12, readings={}, timings=(), complete=True)
    angle = np.concatenate((np.full(round(held * 1000), 0.12), motion.angle))
    return RecordedRun(name='run', run=run, time=np.arange(angle.size) * 1e-3, angle=angle)


def test_motion_of_an_ideal_plant_gives_its_threshold():
    evidence = evidence_from_motion([recorded(NOMINAL, rpm) for rpm in (1800, 2240, 2780)], NOMINAL)
    small = [2 * np.pi / slow_frequency_exact(NOMINAL, speed) for speed in evidence.timed.forcing]
    assert evidence.timed.period == pytest.approx(small, rel=1e-4)
    fit = direct_fit(evidence, Ruler(amplitude=NOMINAL.amplitude))
    assert fit.omega_crit / RPM == pytest.approx(1354.80, rel=1e-3)


def test_friction_hardly_moves_it():
    plant = load_preset('bearing')
    evidence = evidence_from_motion([recorded(plant, rpm) for rpm in (1800, 2240, 2780)], NOMINAL)
    fit = direct_fit(evidence, Ruler(amplitude=NOMINAL.amplitude))
    assert fit.omega_crit == pytest.approx(omega_crit_exact(plant), rel=2e-3)


def test_what_friction_does_to_the_period_stays_within_the_interval():
    plant = replace(load_preset('as_built_1997'), clearance=0.0)
    evidence = evidence_from_motion([recorded(plant, rpm) for rpm in (2240, 2640, 2780)], NOMINAL)
    small = [2 * np.pi / slow_frequency_exact(plant, speed) for speed in evidence.timed.forcing]
    assert (abs(evidence.timed.period / small - 1) > 2e-3).all()
    fit = direct_fit(evidence, Ruler(amplitude=NOMINAL.amplitude))
    assert fit.interval[0] < omega_crit_exact(plant) < fit.interval[1]


def test_swing_begins_at_the_release_and_ends_where_friction_stops_it():
    stopped = recorded(Plant(coulomb=3.0), 2500)
    time, angle = stopped.free_swing().time, stopped.free_swing().angle
    assert (time[0], angle[0]) == (0, 0.12)
    living = stopped.living_swing()
    assert abs(living.angle[-1]) > 0.02
    assert living.angle.size < angle.size


@pytest.mark.parametrize(('release', 'damping'), [(0.12, 0.0), (0.5, 0.02)])
def test_a_swing_of_minutes_is_fitted_as_a_whole(damping, release):
    """The matrix pencil may not thin it until its phase is lost, and a wide one changes its frequency as it decays."""
    rod = Plant(damping=damping)
    motion = Release(plant=rod, speed=2780 * RPM, angle=release).sampled(150.0, 500.0)
    run = Run(
        number=1, settings={}, speed_asked=2780 * RPM, release=release, readings={}, timings=(), complete=True
    )  # fmt: skip
    found = evidence_from_motion([RecordedRun(name='run', run=run, time=motion.time, angle=motion.angle)], NOMINAL)
    period, sigma = found.timed.period[0], found.timed.period_sigma[0]
    assert abs(period - 2 * np.pi / slow_frequency_exact(rod, 2780 * RPM)) < 2 * sigma
    assert sigma < (1e-4 if release == 0.12 else 1e-2) * period


def test_no_runs_tell_nothing():
    with pytest.raises(AnalysisError, match='no run'):
        evidence_from_motion([], NOMINAL)


@pytest.mark.parametrize('kappa', [1.0, 0.7069])
@pytest.mark.parametrize('rpm', [2240, 2780])
@pytest.mark.parametrize('release', [0.05, 0.12, 0.25, 0.5, 0.7])
def test_a_wide_swing_is_reduced_to_a_small_one_within_its_error(kappa, rpm, release):
    """Of a rod that is not the nominal one, too."""
    rod = Plant(inertia_factor=kappa)
    motion = Release(plant=rod, speed=rpm * RPM, angle=release).sampled(6.0)
    run = Run(
        number=1, settings={}, speed_asked=rpm * RPM, release=release, readings={}, timings=(), complete=True
    )  # fmt: skip
    found = evidence_from_motion([RecordedRun(name='run', run=run, time=motion.time, angle=motion.angle)], NOMINAL)
    period, sigma = found.timed.period[0], found.timed.period_sigma[0]
    exact = 2 * np.pi / slow_frequency_exact(rod, rpm * RPM)
    assert abs(period - exact) < 2 * sigma
    assert sigma < 0.02 * exact


def test_a_swing_too_wide_for_that_is_refused_by_the_name_of_its_run():
    motion = Release(plant=NOMINAL, speed=1700 * RPM, angle=0.7).sampled(6.0)
    run = Run(
        number=1, settings={}, speed_asked=1700 * RPM, release=0.7, readings={}, timings=(), complete=True
    )  # fmt: skip
    with pytest.raises(AnalysisError, match=r'^run_01: '):
        evidence_from_motion([RecordedRun(name='run_01', run=run, time=motion.time, angle=motion.angle)], NOMINAL)


def test_a_swing_ends_where_another_speed_is_asked_for():
    first, second = (Release(plant=NOMINAL, speed=rpm * RPM, angle=0.12).sampled(3.0) for rpm in (2400, 1900))
    time = np.concatenate((first.time, first.time[-1] + second.time[1:]))
    run = Run(number=1, settings={}, speed_asked=1900 * RPM, release=0.12, readings={}, timings=(), complete=True)
    recorded = RecordedRun(
        name='run',
        run=run,
        time=time,
        angle=np.concatenate((first.angle, second.angle[1:])),
        asked=((0.0, 2400 * RPM), (3.0, 1900 * RPM)),
    )
    (swing,) = recorded.swings()
    assert (swing.released, swing.time[-1]) == pytest.approx((0.0, 3.0))
    assert recorded.forcing_of(swing) == 2400 * RPM
    with pytest.raises(AnalysisError, match='the speed was changed in this run'):
        evidence_from_motion([recorded], NOMINAL)


def test_a_motion_that_is_over_before_a_hand_could_let_go_is_no_swing():
    short = replace(recorded(NOMINAL, 2500), time=np.arange(20) * 1e-3, angle=np.linspace(0.12, 0.11, 20))
    assert short.swings() == ()
    with pytest.raises(AnalysisError, match='shows no swing'):
        short.free_swing()
