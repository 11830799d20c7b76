"""`kapitsa analyse` and `kapitsa bag info` on the shipped runs."""

import itertools
import json
import re

import pytest
from click.testing import CliRunner

from kapitsa_ros.analysis.slow_frequency import ESTIMATORS
from kapitsa_ros.cli.commands.analyse import analyse
from kapitsa_ros.cli.commands.bag import bag
from kapitsa_ros.cli.transliteration import transliterate
from kapitsa_ros.resources import resource_path
from kapitsa_ros.rig.errors import UsageError

BAGS = [str(resource_path('bags', name)) for name in ('run_01_2240rpm', 'run_02_2640rpm', 'run_03_2780rpm')]


def output(command, *arguments):
    result = CliRunner().invoke(command, arguments, env={'COLUMNS': '120'})
    assert result.exception is None, result.exception
    return result.stdout


@pytest.mark.parametrize('options', [(), ('--motion',)])
def test_readings_of_1997_stand_beside_the_run_at_their_speed(options):
    rows = [
        [cell.strip() for cell in line.strip('│').split('│')]
        for line in output(analyse, BAGS[1], *options).splitlines()
        if line.startswith('│')
    ]
    of_1997 = [['2640', '0.75', '80'], ['2240', '1.00', '60'], ['2780', '0.68', '88']]
    assert [row[1:4] for row in rows[3:6]] == of_1997
    assert [row[4] for row in rows[3:6]] == ['2640.0', '', '']


def test_an_end_without_a_timing_is_explained_where_there_is_one():
    said = 'stopped: friction brought the rod to rest before its swings were timed'
    assert said in output(analyse, *BAGS)
    assert said not in output(analyse, *BAGS[1:])


def test_the_three_tables_stand_beside_1997():
    values = json.loads(output(analyse, *BAGS, '--json'))
    rows = [
        [cell.strip() for cell in line.strip('│').split('│')]
        for line in output(analyse, *BAGS).splitlines()
        if line.startswith('│')
    ]
    ruler = f'({1e3 * values["ruler"]["amplitude_m"]:.3f} ± 0.125) mm'
    assert rows[:3] == [['L', '9.75 in', '9.75 in'], ['λ', '0.5 in', '0.5 in'], ['λ by the ruler', '', ruler]]
    stopped, *timed = rows[3:7]  # friction stopped the first swing, and it was let go from farther out
    assert stopped == ['1', '', '', '', '2240.0', 'stopped', '']
    for number, (row, run) in enumerate(zip(timed, values['runs'], strict=True), start=1):
        assert row[0] == str(number)
        assert row[4:] == [f'{run["speed_reading_rpm"]:.1f}', f'{run["period_s"]:.3f}', f'{run["slow_rpm"]:.1f}']
    assert [row[1:4] for row in timed] == [['2240', '1.00', '60'], ['2640', '0.75', '80'], ['2780', '0.68', '88']]
    low, high = values['omega_crit_interval_rpm']
    assert {row[0]: row[1:] for row in rows[7:]} == {
        'experiment: ω² on Ω², as in 1997': ['1640.0 RPM', f'{values["inverse_rpm"]:.1f} RPM'],
        'experiment: Ω² on ω²': ['1636.2 RPM', f'{values["ols_rpm"]:.1f} RPM'],
        'predicted': ['1353.1 RPM', '1353.1 RPM'],
        'deviation of the fit of 1997': [
            '+21.2 %',
            f'{100 * (values["inverse_rpm"] / values["predicted_rpm"] - 1):+.1f} %',
        ],
        'best estimate: the exact curve': ['', f'{values["omega_crit_rpm"]:.0f} RPM'],
        'its 95 % interval': ['', f'{low:.0f} to {high:.0f} RPM'],
        'exact threshold of the plant simulated': ['', '1594.92 RPM'],
        'deviation of the best estimate from it': ['', f'{values["deviation_percent"]:+.2f} %'],
    }


# The first is what is used where no estimator is named; those of the spectrum hang on the length of the record.
@pytest.mark.parametrize(
    ('chosen', 'periods', 'within'),
    [
        ([], [0.98332, 0.73531, 0.67876], 1e-5),
        (['--estimator', 'sinusoid_fit'], [0.98332, 0.73531, 0.67876], 1e-5),
        (['--estimator', 'zero_crossings'], [0.983, 0.735, 0.679], 3e-3),
        (['--estimator', 'spectral_peak'], [0.983, 0.735, 0.679], 0.1),
    ],
)
def test_the_motion_gives_the_threshold_of_the_plant_by_every_estimator(chosen, periods, within):
    values = json.loads(output(analyse, *BAGS, '--motion', *chosen, '--json'))
    low, high = values['omega_crit_interval_rpm']
    assert low < values['truth_rpm'] < high
    assert values['truth_rpm'] == pytest.approx(1594.92, abs=0.01)
    assert [run['period_s'] for run in values['runs']] == pytest.approx(periods, abs=within)


def test_every_estimator_can_be_chosen():
    (option,) = (option for option in analyse.params if option.name == 'estimator')
    assert list(option.type.choices) == list(ESTIMATORS) == ['sinusoid_fit', 'spectral_peak', 'zero_crossings']


def test_a_blind_analysis_takes_no_estimator():
    error = CliRunner().invoke(analyse, [*BAGS, '--estimator', 'sinusoid_fit']).exception
    assert isinstance(error, UsageError)
    assert str(error) == '--estimator sinusoid_fit: a blind analysis takes the readings: give --motion too'


def test_a_bag_says_what_is_in_it():
    values = json.loads(output(bag, 'info', BAGS[0], '--json'))
    assert values == {
        'messages': 939,
        'duration_s': pytest.approx(15.5, abs=0.2),
        'complete': True,
        'gaps': 0,
        'lost_s': 0.0,
        'first_stamp_s': pytest.approx(86400.0, abs=0.2),
        'last_stamp_s': values['first_stamp_s'] + values['duration_s'],
        'digest': '61c74effe63c2e12864d7078d737a446a2fb5f6693c13745343228fcf6d8b408',
        'digest_ok': None,
        'run': 1,
        'seed': 1997,
        'plant': values['plant'],
        'versions': values['versions'],
        'processor': None,
        'defects': [],
    }
    assert values['plant']['coulomb'] == 0.7
    assert values['versions']['numpy'] == '2.4.6'
    shown = output(bag, 'info', BAGS[0])
    assert re.search(r'│ messages +│ +939 │', shown)
    assert 'unverified: no digest' in shown


def test_a_folder_of_runs_is_analysed_as_its_runs_and_ends_with_what_it_means():
    folder = str(resource_path('bags'))
    assert json.loads(output(analyse, folder, '--json')) == json.loads(output(analyse, *BAGS, '--json'))
    text = ' '.join(output(analyse, folder).split())
    assert 'The critical speed is 1595 RPM by these readings, 1529 to 1622 RPM (95 %).' in text
    assert 'Theory predicts 1353 RPM for the ideal rod, below that' in text
    assert 'A swing took 0.98, 0.71, 0.69 s, where theory has 0.62, 0.48, 0.45 s.' in text
    assert 'gives 1256 to 1785 RPM (16 to 84 % of the 38 experiments that give a line), so its deviation' in text


@pytest.fixture(scope='module')
def whole(kapitsa):
    environment = {'PYTHONIOENCODING': 'utf-8', 'COLUMNS': '160'}
    return kapitsa('analyse', '--budget', resource_path('bags'), env=environment).out


@pytest.mark.parametrize(('encoding', 'columns'), [('ascii', '40'), ('ascii', '80'), ('latin-1', '40')])
def test_terminals_that_are_narrow_or_know_no_greek_lose_nothing(kapitsa, whole, encoding, columns):
    bags = str(resource_path('bags'))
    answer = kapitsa('analyse', '--budget', bags, env={'PYTHONIOENCODING': encoding, 'COLUMNS': columns})
    assert answer.status == 0, answer.err
    for number in re.findall(r'\d+\.\d+', whole):
        assert number in answer.out
    lines = answer.out.splitlines()
    assert max(map(len, lines)) <= int(columns)
    assert '...' not in answer.out
    for above, below in itertools.pairwise(lines):  # a table's lines are as long as its borders
        if above.startswith('+--') and below.startswith('|'):
            assert len(above) == len(below)
        if above.startswith('|') and below.startswith('+--'):
            assert len(above) == len(below)
    shown = ''.join(re.findall(r'[a-z]', answer.out.lower()))
    for words in ('lambda', 'omega', 'thecriticalspeedis', 'estimate'):
        assert words in shown


def test_signs_are_written_out():
    written = transliterate('Ω² = k²λ²ω²/2 − kg ± 1 µm, θ′ é 中')
    assert written == "Omega^2 = k^2lambda^2omega^2/2 - kg +/- 1 um, theta' e \\u4e2d"


def test_bag_info_says_whether_the_run_is_whole_and_what_to_do_next():
    text = ' '.join(output(bag, 'info', BAGS[0]).split())
    assert 'simulated time (s) │ 15.5 │' in text
    assert 'The run is whole: it came to its end' in text
    assert f'Next: `kapitsa analyse {BAGS[0]}`' in text.replace('\n', '')
