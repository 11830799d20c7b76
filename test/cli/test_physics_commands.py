import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from kapitsa_ros.cli.commands.figures import figures
from kapitsa_ros.cli.commands.simulate import simulate
from kapitsa_ros.cli.commands.theory import theory
from kapitsa_ros.errors import OutputError
from kapitsa_ros.physics.errors import ParameterError, PhysicsError
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory import growth_rate
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.units import RPM

RUN = ('--speed', '2500', '--release', '0.12', '--duration', '2')


def answer(command, *arguments):
    result = CliRunner().invoke(command, [*arguments, '--json'])
    assert result.exception is None, result.exception
    return json.loads(result.stdout)


def test_theory():
    values = answer(theory, '--speed', '2500', '--speed', '20Hz')
    assert values['mathieu_q'] == pytest.approx(0.153846, abs=1e-6)
    assert values['omega_crit_averaged_rpm'] == pytest.approx(1353.0583736, abs=1e-6)
    assert values['omega_crit_exact_rpm'] == pytest.approx(1354.8036386, abs=1e-6)
    assert values['omega_crit_upper_rpm'] is None
    fast, slow = values['speeds']
    assert fast == {
        'speed_rpm': pytest.approx(2500),
        'mathieu_a': pytest.approx(-0.0034665410, rel=1e-8),
        'stable': True,
        'slow_averaged_rpm': pytest.approx(114.3445, abs=1e-4),
        'slow_exact_rpm': pytest.approx(114.8162197, abs=1e-6),
        'growth_per_s': 0.0,
    }
    assert slow['speed_rpm'] == pytest.approx(1200)
    assert slow['stable'] is False
    assert slow['slow_exact_rpm'] is None
    assert slow['growth_per_s'] == pytest.approx(3.5985719, rel=1e-7)


def test_theory_of_a_short_rod_has_both_limits():
    values = answer(theory, '--length', '4in', '--amplitude', '2in', '--damping', '5')
    assert values['omega_crit_upper_rpm'] > values['omega_crit_exact_rpm']


def test_comparison_of_theories():
    theories = answer(theory, '--speed', '2500', '--release', '0.12')['speeds'][0]['ladder']
    assert theories[-1]['slow_rpm'] == pytest.approx(114.17356201, abs=1e-7)
    assert 'Butikov' in CliRunner().invoke(theory, ['--speed', '2500', '--release', '0.12']).output


def test_simulate():
    values = answer(simulate, *RUN)
    assert set(values) == {
        'slow_rpm',
        'growth_per_s',
        'max_angle_rad',
        'fell',
        'final_angle_rad',
        'stuck',
        'periods',
    }
    assert values['slow_rpm'] == pytest.approx(114.17356201, abs=1e-7)
    assert values['periods'] == pytest.approx(2 * 114.17356201 / 60, rel=1e-8)
    assert values['fell'] is False


def test_simulate_a_fall():
    values = answer(simulate, '--speed', '1200', '--release', '0.01', '--duration', '5')
    assert values['fell'] is True
    assert values['slow_rpm'] is None
    assert values['growth_per_s'] == pytest.approx(3.6, rel=0.01)


def test_simulate_until_it_sticks():
    swinging = answer(simulate, *RUN[:4], '--duration', '10', '--coulomb', '2')
    assert abs(swinging['final_angle_rad']) < 0.002
    assert swinging['growth_per_s'] < 0
    assert 2 < swinging['periods'] < 4
    inside = answer(simulate, '--speed', '2500', '--release', '3e-4', '--duration', '1', '--coulomb', '2')
    assert inside['stuck'] is True
    assert inside['final_angle_rad'] == 3e-4


@pytest.mark.parametrize('suffix', ['csv', 'npz', 'parquet'])
def test_motion_is_written_with_all_its_digits(tmp_path, suffix):
    if suffix == 'parquet':
        pytest.importorskip('pyarrow')
    file = tmp_path / f'motion.{suffix}'
    last = answer(simulate, *RUN, '--output', str(file), '--sample-rate', '500')['final_angle_rad']
    if suffix == 'csv':
        table = np.genfromtxt(file, delimiter=',', names=True)
    elif suffix == 'npz':
        table = np.load(file)
    else:
        table = pytest.importorskip('pyarrow.parquet').read_table(file).to_pydict()
    assert len(table['time_s']) == 1001
    assert table['angle_rad'][-1] == last
    assert table['time_s'][-1] == 2.0
    assert table['pivot_m'][0] == -0.0127
    assert table['rate_rad_s'][0] == 0.0


@pytest.mark.parametrize(
    ('arguments', 'error'),
    [
        (['--output', 'motion.txt'], OutputError),
        (['--sample-rate', '0'], ParameterError),
        (['--duration', 'nan'], ParameterError),
        (['--release', '2'], ParameterError),
        (['--speed', '0'], ParameterError),
        (['--length', '-1'], ParameterError),
    ],
)
def test_simulate_refuses(arguments, error):
    assert isinstance(CliRunner().invoke(simulate, [*RUN, *arguments]).exception, error)


def test_an_unstable_rod_that_has_not_fallen_yet_has_its_growth():
    arguments = ['--speed', '1300', '--release', '0.01', '--duration', '1']
    values = answer(simulate, *arguments)
    assert values['slow_rpm'] is None
    assert values['fell'] is False
    assert values['growth_per_s'] == pytest.approx(growth_rate(Plant(), 1300 * RPM), rel=0.01)
    assert 'unstable: it would fall' in CliRunner().invoke(simulate, arguments).output
    assert 'unstable' not in CliRunner().invoke(simulate, RUN).output


@pytest.mark.parametrize(
    'more',
    [
        ['--speed', '1300', '--release', '0.05', '--clearance', '2mm'],  # its threshold is 1251 RPM
        ['--speed', '1300', '--release', '1e-4', '--coulomb', '2'],
    ],
)
def test_what_play_or_friction_holds_up_is_not_said_to_fall(more):
    assert 'unstable' not in CliRunner().invoke(simulate, [*more, '--duration', '3']).output


@pytest.mark.parametrize(('restitution', 'slow'), [(0.0, 132.8), (0.8, 132.4), (0.85, 133.5), (0.9, 133.2)])
def test_impacts_in_the_play_are_not_taken_for_turns(restitution, slow):
    """By zero crossings: 132.8, 132.3, 133.3, 133.2 RPM."""
    arguments = ['--speed', '2500', '--release', '0.12', '--duration', '20', '--clearance', '3mm']
    values = answer(simulate, *arguments, '--restitution', str(restitution))
    assert values['slow_rpm'] == pytest.approx(slow, abs=0.2)


@pytest.mark.parametrize(
    ('command', 'arguments', 'message'),
    [
        (theory, ['--speed', '0'], r'speed is 0 rad/s: give a finite speed above 0, at most 1e\+06 rad/s'),
        (theory, ['--speed', '1e200'], r'at most 1e\+06 rad/s'),
        (theory, ['--length', '1e-300'], 'give a smaller amplitude or a longer rod'),
        (simulate, ['--speed', '1e9', '--release', '0.1', '--duration', '1'], r'at most 1e\+06 rad/s'),
        (simulate, ['--speed', '1e6', '--release', '0.1', '--duration', '1e4'], 'reduce duration or speed'),
        (
            simulate,
            ['--speed', '2500', '--release', '0.1', '--duration', '1e4', '--sample-rate', '1e9'],
            'reduce duration or sample_rate',
        ),
        (
            simulate,
            ['--speed', '2500', '--release', '0.1', '--duration', '1e300', '--sample-rate', '1e300'],
            'reduce duration or sample_rate',
        ),
    ],
)
def test_what_would_take_for_ever_or_has_no_answer_is_refused(command, arguments, message):
    error = CliRunner().invoke(command, arguments).exception
    assert isinstance(error, PhysicsError)
    assert re.search(message, str(error))


def words(command, *arguments):
    return ' '.join(CliRunner().invoke(command, arguments, env={'COLUMNS': '120'}).stdout.split())


def test_what_was_typed_in_a_unit_is_answered_in_it():
    said = words(simulate, '--speed', '41.5Hz', '--release', '7deg', '--duration', '2')
    assert 'Shaken at 41.5 Hz, let go at 7 deg, followed for 2 s.' in said
    assert re.search(r'slow swing Ω │ 1\.89\d* Hz', said)  # 113.7 RPM
    assert re.search(r'largest angle │ 8\.\d+ deg', said)
    said = words(theory, '--speed', '41.5Hz', '--speed', '1200')
    assert '1354.80 RPM (22.5801 Hz)' in said
    assert '41.5 Hz │ stands' in said
    assert '1200 RPM │ falls' in said


def test_what_becomes_of_a_rod_is_said_in_words():
    assert 'It stands: it swings about upright, and the swing neither grows nor dies.' in words(simulate, *RUN)
    fallen = words(simulate, '--speed', '1200', '--release', '0.12', '--duration', '5')
    assert 'It fell. Next: `kapitsa theory`' in fallen
    assert 'stands upright above 1354.8 RPM' in words(theory)
    assert 'its angle grows tenfold in 0.64 s' in words(theory, '--speed', '1200')  # ln 10 / 3.5986


def test_study(kapitsa):
    values = kapitsa('study', '--duration', '3', '--cycles', '1000', '--json').json['verdicts']
    assert values[-1]['solver'] == 'ours, 1000 cycles'
    assert abs(values[-1]['growth']) < 1e-9


SPOILT = {'text.usetex': True, 'font.family': ['serif'], 'lines.linewidth': 9.0, 'savefig.dpi': 30}


def test_figures_are_the_same_whatever_matplotlibrc_says(tmp_path):
    mpl = pytest.importorskip('matplotlib')
    drawn = answer(figures, '--output', str(tmp_path / 'plain'), '--format', 'svg')['figures']
    assert [file[-5] for file in drawn] == ['2', '3', '4', '5', '6']
    with mpl.rc_context(SPOILT):
        spoilt = answer(figures, '--output', str(tmp_path / 'spoilt' / 'rig.svg'))['figures']
        assert mpl.rcParams['lines.linewidth'] == 9.0  # the user's own are left as they are
    assert [Path(file).name for file in spoilt] == [f'rig_{number}.svg' for number in range(2, 7)]
    assert [Path(file).read_bytes() for file in spoilt] == [Path(file).read_bytes() for file in drawn]
    assert '>Ω (RPM)</text>' in Path(drawn[-1]).read_text(encoding='utf-8')  # it can be selected


@pytest.mark.parametrize(('kind', 'start'), [('png', b'\x89PNG'), ('pdf', b'%PDF')])
def test_a_figure_in_each_format_tells_no_date(kind, start, tmp_path):
    pytest.importorskip('matplotlib')
    from kapitsa_ros.reporting.figures import FORMATS, save, time_history

    (option,) = (each for each in figures.params if each.name == 'kind')
    assert set(option.type.choices) == set(FORMATS)
    files = [tmp_path / f'{number}.{kind}' for number in range(2)]
    for file in files:
        save(time_history(Plant(), 2500 * RPM), file, kind)
    assert files[0].read_bytes() == files[1].read_bytes()
    assert files[0].read_bytes().startswith(start)
    assert b'Date' not in files[0].read_bytes()


def test_figure_3_is_the_line_of_1997():
    pytest.importorskip('matplotlib')
    from kapitsa_ros.configuration.tables import load_table
    from kapitsa_ros.reporting.figures import report_figures

    (axes,) = report_figures(Plant(), 2500 * RPM, load_table('1997'))[3].axes
    fitted, measured = axes.lines[0].get_xydata(), axes.lines[1].get_xydata()
    assert fitted[0] == pytest.approx([0.0, 1640.0], abs=0.05)
    np.testing.assert_allclose(measured, [[60, 2240], [80, 2640], [60 / 0.68, 2780]])


def test_simulate_a_bending_rod(tmp_path):
    file = tmp_path / 'motion.npz'
    values = answer(simulate, *RUN, '--bending-frequency', '400Hz', '--bending-damping', '0.01', '--output', str(file))
    assert set(values) == set(answer(simulate, *RUN))
    # The damped mode draws on the slow motion; the rigid rod swings at 114.17 RPM.
    assert values['slow_rpm'] == pytest.approx(114.0, abs=0.2)
    assert values['stuck'] is False
    table = np.load(file)
    assert list(table) == ['time_s', 'angle_rad', 'rate_rad_s', 'pivot_m', 'deflection_m']
    assert 1e-6 < np.abs(table['deflection_m']).max() < 1e-3
    bare = answer(simulate, *RUN, '--bending-frequency', '400', '--bending-damping', '0.01')
    assert bare == values


@pytest.mark.parametrize('more', [['--linear'], ['--coulomb', '1'], ['--clearance', '0.1mm']])
def test_a_bending_rod_is_neither_rubbing_nor_linear(more):
    result = CliRunner().invoke(simulate, [*RUN, '--bending-frequency', '400Hz', *more])
    assert 'leave the bending out' in str(result.exception)
    assert isinstance(result.exception, ParameterError)


def test_bending_damping_needs_a_bending_rod():
    result = CliRunner().invoke(simulate, [*RUN, '--bending-damping', '0.1'])
    assert isinstance(result.exception, UsageError)
