"""`import kapitsa_ros as kr`: light, flat, documented, and the same answer in whatever form a quantity is given."""

import doctest
import inspect
import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import kapitsa_ros as kr
from kapitsa_ros.physics import theory
from kapitsa_ros.units import RPM

CHECKOUT = Path(__file__).parents[2]
FUNCTIONS = [name for name in kr.__all__ if name[0].islower()]
FRAMES = {
    'theory': lambda: kr.theory(speed=[150.0, 250.0]),
    'simulate': lambda: kr.simulate(speed=250, release=0.1, duration=0.1),
    'stability_map': lambda: kr.stability_map(speed=[150, 250], amplitude=[0.01, 0.02, 0.03]),
    'reduce': lambda: kr.reduce('1997'),
    'explain': lambda: kr.explain('1997'),
    'plan': lambda: kr.plan(target=3.0),
    'campaign': lambda: kr.campaign(experiments=2),
}


def loaded_by(code: str) -> set[str]:
    code += '\nimport json, sys; print(json.dumps(list(sys.modules)))'
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)
    return set(json.loads(done.stdout.splitlines()[-1]))


def test_the_import_loads_nothing_that_takes_time() -> None:
    modules = loaded_by('import kapitsa_ros as kr; dir(kr); kr.__version__')
    assert not modules & {'numpy', 'scipy', 'numba', 'rclpy', 'rosbags', 'pandas', 'matplotlib', 'yaml', 'click'}
    assert {name for name in modules if name.startswith('kapitsa_ros.')} == set()


def test_ros_waits_for_a_graph() -> None:
    code = 'import kapitsa_ros as kr; kr.theory(kr.Plant(), speed=250); kr.experiment; kr.read_bag; kr.reduce()'
    assert not {name for name in loaded_by(code) if name.split('.')[0] == 'rclpy'}


@pytest.mark.parametrize('module', ['rig.harness', 'web.session', 'nodes.operator', 'nodes.player'])
def test_a_rig_and_a_bench_wait_for_no_fit(module: str) -> None:
    assert not loaded_by(f'import kapitsa_ros.{module}') & {'numba', 'scipy.special', 'scipy.optimize', 'pandas'}


def test_kernels_that_were_compiled_before_need_no_numba() -> None:
    """It takes ten times as long to load as they do."""
    kernels = 'import kapitsa_ros as kr; kr.simulate(speed=250.0, release=0.1, duration=0.1)'
    loaded_by(kernels)
    assert 'numba' not in loaded_by(kernels)


def test_what_is_public_is_found_and_no_module_takes_its_name() -> None:
    for name in kr.__all__:
        assert name in dir(kr)
        assert getattr(kr, name).__doc__
    modules = {path.stem for path in (CHECKOUT / 'kapitsa_ros').iterdir()}
    assert not modules & set(kr.__all__)
    with pytest.raises(AttributeError, match="no attribute 'theories'"):
        kr.theories  # noqa: B018


@pytest.mark.parametrize('name', FUNCTIONS)
def test_the_examples_of_the_docstrings_hold(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(CHECKOUT)
    (test,) = doctest.DocTestFinder(recurse=False).find(inspect.unwrap(getattr(kr, name)), name)
    assert test.examples
    said: list[str] = []
    doctest.DocTestRunner().run(test, out=said.append)
    assert not said, ''.join(said)


def test_the_types_are_known_to_a_checker(tmp_path: Path) -> None:
    script = tmp_path / 'user.py'
    script.write_text(
        'import kapitsa_ros as kr\n'
        'reveal_type(kr.theory(kr.Plant(), speed=kr.rpm(2500)).omega_crit)\n'
        'reveal_type(kr.simulate(speed=1, release=1, duration=1).fell)\n'
        'kr.nothing\n'
    )
    pytest.importorskip('mypy')
    options = [
        '--no-site-packages',
        '--ignore-missing-imports',
        '--cache-dir',
        tmp_path / 'cache',
        '--config-file',
        CHECKOUT / 'pyproject.toml',
    ]
    done = subprocess.run(
        [sys.executable, '-m', 'mypy', *options, script], capture_output=True, text=True, check=False, cwd=CHECKOUT
    )
    assert 'Revealed type is "float"' in done.stdout.replace('builtins.', '')
    assert 'Revealed type is "bool"' in done.stdout.replace('builtins.', '')
    assert 'Module has no attribute "nothing"' in done.stdout


@pytest.mark.parametrize('damping', [0.0, 1.0])
def test_many_speeds_are_answered_as_one_is(damping: float) -> None:
    plant = kr.Plant(damping=damping)
    speeds = kr.rpm(np.linspace(100.0, 60_000.0, 2000))
    found = kr.theory(plant, speed=speeds)
    slow = [theory.slow_frequency_exact(plant, speed) for speed in speeds]
    np.testing.assert_allclose(found.slow, np.array(slow, dtype=float), rtol=1e-15)
    growth = np.array([theory.growth_rate(plant, speed) for speed in speeds])
    np.testing.assert_allclose(found.growth, growth, rtol=1e-15, atol=1e-15)
    assert found.stable.tolist() == [theory.is_stable(plant, speed) for speed in speeds]
    averaged = [theory.slow_frequency_averaged(plant, speed) for speed in speeds]
    np.testing.assert_allclose(found.slow_averaged, np.array(averaged, dtype=float), rtol=1e-14)
    np.testing.assert_allclose(found.mathieu_a, [theory.mathieu_a(plant, speed) for speed in speeds], rtol=1e-15)
    assert found.warnings == ()
    grid = kr.theory(plant, speed=speeds.reshape(40, 50))
    np.testing.assert_array_equal(grid.slow, found.slow.reshape(40, 50))


def test_speeds_without_an_answer_are_nan_and_said_to_be_and_a_single_one_is_an_error() -> None:
    found = kr.theory(speed=[0.0, math.nan, -3.0, 1e-4, 250.0])
    assert np.isnan(found.growth).tolist() == np.isnan(found.slow).tolist() == [True, True, True, True, False]
    assert found.stable.tolist() == [False, False, False, False, True]
    assert [warning.split()[0:4] for warning in found.warnings] == [['3', 'of', '5', 'speeds'], ['at', '1', 'of', '5']]
    for speed in (0.0, -3.0, 1e-4, math.nan):
        with pytest.raises(kr.KapitsaError, match=r'speed above 0|falls too fast'):
            kr.theory(speed=speed)


class Pinned:
    """A quantity of a library of units, as far as it is asked for."""

    def __init__(self, magnitude: float, units: str, factor: float) -> None:
        self.magnitude, self.units, self._factor = magnitude, units, factor

    def to(self, unit: str) -> 'Pinned':
        return Pinned(self.magnitude * self._factor, unit, 1.0)


FORMS = [
    2500 * RPM, '2500 rpm', '2500rpm', kr.rpm(2500), np.float64(2500 * RPM), f'{2500 / 60!r} Hz',
    Pinned(2500, 'revolutions_per_minute', RPM), Pinned(2500 / 60, 'hertz', 1.0),
]  # fmt: skip


@pytest.mark.parametrize('speed', FORMS)
def test_a_speed_is_the_same_in_all_its_forms(speed: object) -> None:
    assert float(kr.theory(speed=speed).slow) == pytest.approx(float(kr.theory(speed=2500 * RPM).slow), rel=1e-13)
    assert kr.theory(speed=[speed, speed]).speed == pytest.approx(2500 * RPM, rel=1e-14)
    assert kr.simulate(speed=speed, release=0.1, duration=0.1).run.speed == pytest.approx(2500 * RPM, rel=1e-14)


def test_angles_and_times_are_the_same_in_all_their_forms() -> None:
    plain = kr.simulate(speed=250, release=math.radians(7), duration=6.0)
    texts = kr.simulate(speed='250 rad/s', release='7 deg', duration='0.1 min', sample_rate='1000 Hz')
    np.testing.assert_allclose(texts.angle, plain.angle, atol=1e-9)
    assert texts.time[-1] == plain.time[-1] == 6.0


def test_a_pint_quantity_will_do() -> None:
    pint = pytest.importorskip('pint')
    units = pint.UnitRegistry()
    speeds = np.array([1500.0, 2500.0])
    assert kr.theory(speed=speeds * units.rpm).speed == pytest.approx(kr.rpm(speeds))
    assert kr.theory(speed=40 * units.Hz).speed == pytest.approx(80 * math.pi)


@pytest.mark.parametrize('wrong', ['fast', '3 m', True, None, [1, 'x'], [True], {}, 1j, Pinned])
def test_what_is_no_speed_is_refused_by_name(wrong: object) -> None:
    with pytest.raises(kr.KapitsaError, match=r"^speed is .*: give a quantity in rad/s, as in 234.6, '2240 rpm'"):
        kr.theory(speed=wrong)


@pytest.mark.parametrize('call', ['theory', 'simulate', 'stability_map', 'reduce', 'plan', 'campaign'])
def test_whoever_shows_a_speed_shows_it_in_both_units(call: str) -> None:
    said = repr(FRAMES[call]())
    assert said.count(' rad/s (') == said.count(' RPM)') > 0


def test_data_frames_name_their_units_and_have_all_rows() -> None:
    pytest.importorskip('pandas')
    rows = {
        'theory': (2, 'speed_rad_s speed_rpm mathieu_a stable slow_rad_s slow_rpm slow_averaged_rad_s growth_per_s'),
        'simulate': (101, 'time_s angle_rad rate_rad_s pivot_m'),
        'stability_map': (6, 'speed_rad_s speed_rpm amplitude_m stable half_trace'),
        'reduce': (4, 'fit omega_crit_rad_s omega_crit_rpm low_rad_s high_rad_s'),
        'explain': (12, 'name parameter value chi_squared weight fits rms_misfit_s low high'),
        'plan': (2, 'speed_rad_s speed_rpm swings repeats'),
        'campaign': (2, 'seed omega_crit_rad_s omega_crit_rpm low_rad_s high_rad_s truth_rad_s'),
    }
    for call, (count, columns) in rows.items():
        frame = FRAMES[call]().to_pandas()
        assert (len(frame), ' '.join(frame.columns)) == (count, columns)


def test_without_pandas_the_mend_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, 'pandas', None)
    with pytest.raises(kr.KapitsaError, match=r'a data frame needs pandas: .*pip install "kapitsa_ros\[report\]"'):
        FRAMES['theory']().to_pandas()


@pytest.mark.parametrize('call', ['theory', 'simulate', 'stability_map', 'reduce', 'campaign'])
def test_plots_are_drawn(call: str, tmp_path: Path) -> None:
    pytest.importorskip('matplotlib')
    figure = FRAMES[call]().plot()
    figure.savefig(tmp_path / 'plot.png')
    (axes,) = figure.axes
    assert axes.get_xlabel()
    assert axes.has_data()


def test_readings_are_the_same_as_columns_table_or_path() -> None:
    table = kr.reduce('1997')
    columns = (['2240 rpm', '2640 rpm', '2780 rpm'], [1.0, 0.75, 0.68])
    same = [CHECKOUT / 'config' / 'tables' / '1997.csv', table.readings, columns, (*columns, 0.0, '50 ms')]
    for readings in same:
        found = kr.reduce(readings)
        assert (found.inverse_ols, found.eiv) == pytest.approx((table.inverse_ols, table.eiv), rel=1e-9)
        assert found.eiv_interval == pytest.approx(table.eiv_interval, rel=1e-6)
    for wrong in ([1.0, 2.0], (1.0,), None):
        with pytest.raises(kr.KapitsaError, match='readings: give a table by name or path'):
            kr.reduce(wrong)


def test_a_plant_may_be_named() -> None:
    assert kr.theory('bearing').plant == kr.preset('bearing')
    with pytest.raises(kr.KapitsaError, match='nope'):
        kr.theory('nope')


def test_a_rod_is_described_as_a_person_says_it() -> None:
    rod = kr.Plant(length='9.75in', amplitude='0.5 in')
    assert (rod.length, rod.amplitude) == (0.24765, 0.0127)
    assert kr.preset('bearing', length='9.75 in') == kr.preset('bearing')


def test_a_bag_that_counts_twice_is_told_of(tmp_path: Path) -> None:
    pytest.importorskip('matplotlib')
    bag = min((CHECKOUT / 'bags').glob('run_*'))
    told = kr.report([bag, str(bag)], tmp_path / 'r.html').warnings[0]
    assert told.startswith(f'{bag.name} is given more')


def test_what_was_allowed_for_or_left_out_stands_beside_the_numbers() -> None:
    apart = kr.reduce((['2240 rpm', '2240 rpm', '2780 rpm'], [1.0, 0.98, 0.68], [0.0] * 3, [1e-3] * 3))
    assert '1.4 % of each period is added to its uncertainty' in repr(apart)
    assert '1 of 2 speeds are not above 0 and at most 1e+06 rad/s' in repr(kr.theory(speed=[0.0, 250.0]))
    assert 'warnings        none' in repr(kr.theory(speed=250.0))
