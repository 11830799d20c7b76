import base64
import re
import zlib
from contextlib import suppress
from dataclasses import replace
from html.parser import HTMLParser

import pytest
from click.testing import CliRunner

pytest.importorskip('matplotlib')
pytest.importorskip('jinja2')

from kapitsa_ros.analysis.critical_speed import direct_fit, evidence_of, ruler_of
from kapitsa_ros.analysis.experiment import budget_of
from kapitsa_ros.analysis.recorded_run import RecordedRun
from kapitsa_ros.analysis.timing_row import timing_rows
from kapitsa_ros.cli.commands.report import report
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.tables import load_table
from kapitsa_ros.errors import OutputError
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.operator.protocol import Protocol
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.release import Release
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.reporting.report import WRITERS, as_html, gather, report_document
from kapitsa_ros.reporting.report.drawings import drawings_of
from kapitsa_ros.resources import resource_path
from kapitsa_ros.schema import describe
from kapitsa_ros.units import RPM


@pytest.fixture(scope='module')
def runs():
    recorded = []
    for path in sorted(resource_path('bags').iterdir()):
        bag = RunBag(path)
        seconds = (bag.motion.stamps_ns - bag.motion.stamps_ns[0]) / SECOND
        recorded.append(RecordedRun(name=path.name, run=bag.run, time=seconds, angle=bag.motion.angle))
    return recorded


@pytest.fixture(scope='module')
def content(runs):
    return gather(runs, load_table('1997'), experiments=2)


@pytest.fixture(scope='module')
def page(content):
    return as_html(report_document(content))


@pytest.fixture(scope='module')
def of_one_bag(runs):
    return gather(runs[:1], load_table('1997'), experiments=1)


class _Reader(HTMLParser):
    def __init__(self):
        super().__init__()
        self.text, self.references, self.tags = '', [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.references += [value for name, value in attrs if name in ('src', 'href', 'xlink:href', 'data', 'action')]

    def handle_data(self, data):
        self.text += data


def test_no_request_leaves_the_file(page):
    reader = _Reader()
    reader.feed(page)
    assert all(reference.startswith('#') for reference in reader.references)
    assert all(target.startswith('#') for target in re.findall(r'url\(([^)]*)\)', page))
    assert '@import' not in page
    assert not {'script', 'link', 'iframe', 'object'} & set(reader.tags)


def test_tables_and_figures_of_1997_stand_beside_the_runs(page, runs):
    reader = _Reader()
    reader.feed(page)
    for number in (1, 2, 3):
        assert f'Table {number}' in reader.text
    for number in (2, 3, 4, 5, 6):
        assert f'aria-label="Figure {number}' in page
    for figure in ('1640.0', '1636.2', '1353.06', '+21.2 %', f'{runs[0].run.period:.3f}'):
        assert figure in reader.text
    fit = direct_fit(evidence_of(timing_rows([run.run for run in runs])), ruler_of(runs[0].run))
    assert f'{fit.omega_crit / RPM:.0f} RPM' in reader.text
    assert 'inertia factor, large swing, amplitude, stopwatch scale' in reader.text


def test_it_says_whether_a_bearing_would_have_given_the_answer(page):
    reader = _Reader()
    reader.feed(page)
    answer = ' '.join(reader.text.split())
    assert 'Not by itself. On the bearing the report recommends' in answer
    assert 'bearing, inertia as built' in answer
    for truth in ('1354.8', '1594.9', '1610.3'):
        assert truth in answer


def test_one_bag_makes_a_report_without_lines(runs, of_one_bag):
    reader = _Reader()
    reader.feed(as_html(report_document(of_one_bag)))
    fit = direct_fit(evidence_of(timing_rows([runs[0].run])), ruler_of(runs[0].run))
    assert f'{fit.omega_crit / RPM:.0f} RPM' in reader.text
    assert 'Single causes against the readings of these runs' not in reader.text


def test_runs_off_the_curve_are_said_to_be(of_one_bag):
    *others, best = of_one_bag.estimates
    for discrepancy, words in ((0.004, '0.4 % of each period'), (None, 'contradict one another')):
        reader = _Reader()
        changed = replace(of_one_bag, estimates=(*others, replace(best, discrepancy=discrepancy)))
        reader.feed(as_html(report_document(changed)))
        assert words in reader.text


def test_a_fall_alone_makes_a_report_that_shows_it():
    protocol = Protocol(speeds=(1340 * RPM,))
    experiment = SimulatedExperiment(plant=Plant(), instruments=load_instruments('1997'), protocol=protocol, seed=1)
    [run] = experiment.runs()
    assert run.fell
    fall = Release(plant=Plant(), speed=1340 * RPM, angle=0.12).sampled(5.0)
    recorded = RecordedRun(name='run_01_1340rpm', run=run, time=fall.time, angle=fall.angle)
    page = as_html(report_document(gather([recorded], load_table('1997'), experiments=1)))
    for words in ('these runs give no critical speed', '<td>fell</td>', 'Figure 4'):
        assert words in page


def test_a_run_without_motion_makes_a_report_without_its_figures(runs):
    still = [replace(recorded, time=recorded.time[:0], angle=recorded.angle[:0]) for recorded in runs]
    page = as_html(report_document(gather(still, load_table('1997'), experiments=1)))
    assert 'Figure 3' in page
    assert 'Figure 4' not in page


def test_all_formats_say_the_same(of_one_bag, page, tmp_path):
    WRITERS['md'](report_document(of_one_bag), tmp_path / 'report.md')
    text = (tmp_path / 'report.md').read_text(encoding='utf-8')
    reader = _Reader()
    reader.feed(as_html(report_document(of_one_bag)))
    for title in re.findall(r'^\*\*(Table \d.*)\*\*$|^## (.*)$', text, re.MULTILINE):
        assert ''.join(title) in reader.text
    best = f'{of_one_bag.curve.omega_crit / RPM:.0f} RPM'
    assert best in text
    assert best in reader.text
    drawn = [base64.b64decode(data).decode() for data in re.findall(r'image/svg\+xml;base64,([^)]*)', text)]
    assert (
        len(drawn) == len(drawings_of(of_one_bag)) == len(re.findall('<figure[ >]', page)) - 4
    )  # two runs with two figures each
    assert all('<text' in drawing for drawing in drawn)  # it can be selected


@pytest.fixture(scope='module')
def pdf(of_one_bag, tmp_path_factory):
    path = tmp_path_factory.mktemp('report') / 'report.pdf'
    WRITERS['pdf'](report_document(of_one_bag), path)
    return path.read_bytes()


def test_pdf_has_pages_of_a4(pdf):
    assert pdf.startswith(b'%PDF-')
    assert b'/MediaBox [0 0 595.28 841.89]' in pdf
    assert int(re.search(rb'/Count (\d+)', pdf)[1]) >= 5


def test_history_and_spectrum_of_a_swing_stand_side_by_side_in_pdf(pdf, of_one_bag):
    titles = [drawing.title for drawing in drawings_of(of_one_bag)]
    heights = {}
    for stream in re.findall(rb'stream\n(.*?)\nendstream', pdf, re.DOTALL):
        with suppress(zlib.error):  # a font or a picture
            for height, number in re.findall(rb' ([-\d.]+) cm /I(\d+) Do', zlib.decompress(stream)):
                heights[titles[int(number) - 1]] = height
    assert set(heights) == set(titles)
    swings = [title.removeprefix('Figure 4: time history') for title in titles if title.startswith('Figure 4')]
    assert swings
    for swing in swings:
        assert heights[f'Figure 4: time history{swing}'] == heights[f'Figure 5: spectrum{swing}']


def test_every_parameter_of_the_plant_and_every_run_is_in_it(page, runs):
    for item in describe(Plant):
        assert f'<td>{item.name.replace("_", " ")}</td>' in page
    expected = []
    for recorded in runs:
        swings = recorded.swings()
        assert [recorded.timing_of(swing) for swing in swings] == list(recorded.run.timings)
        names = [f', swing {number} of {len(swings)}' for number in range(1, len(swings) + 1)] if swings[1:] else ['']
        for name in names:
            assert f'aria-label="Figure 4: time history of θ, {recorded.name}{name}"' in page
            assert f'aria-label="Figure 5: spectrum of θ, {recorded.name}{name}"' in page
            expected.append(60.0 / recorded.run.period)
    named = [float(text) for text in re.findall(r'Ω = ([\d.]+) RPM', page)]
    assert named == pytest.approx(expected, rel=0.1)
    assert 'friction stops it before it is timed, 2240 RPM asked for' in page


def test_uncertainty_and_discussion_follow_from_the_numbers(content, page, runs):
    reader = _Reader()
    reader.feed(page)
    text = ' '.join(reader.text.split())
    budget = budget_of([recorded.run for recorded in runs])
    assert f'u_c = {budget.u / RPM:.0f} RPM' in text
    assert 'Most of the uncertainty comes from play D' in text
    assert 'The interval holds the exact threshold of the plant simulated' in text
    _, low, high = content.trials[0].inverse_ols
    assert f'16 to 84 % of the {content.trials[0].lines} experiments that give a line' in text
    is_within = low <= content.estimates[0].of_1997 <= high
    assert ('as a deviation of the critical speed they are not significant' in text) == is_within
    assert ('lie outside of it' in text) != is_within


def test_what_is_missing_in_a_bag_stands_in_the_report(runs, content):
    lacking = replace(runs[0], defects=('steps 7 to 9 of run 1: missing',), unverified=True)
    page = as_html(report_document(replace(content, runs=(lacking, *runs[1:]))))
    assert f'{runs[0].name}: steps 7 to 9 of run 1: missing.' in page
    assert f'Unverified, as no digest is recorded with them: {runs[0].name}.' in page


def test_swing_begins_where_it_was_let_go(runs):
    for recorded in runs:
        swing = recorded.free_swing()
        time, angle = swing.time, swing.angle
        assert time[0] == 0
        assert abs(angle[0]) == pytest.approx(recorded.run.release, rel=0.01)
        assert time[-1] > 1.0


def test_folder_that_is_not_there_is_refused_before_the_work(tmp_path):
    bag = str(resource_path('bags', 'run_01_2240rpm'))
    result = CliRunner().invoke(report, [bag, '--output', str(tmp_path / 'nowhere' / 'r.html')])
    assert isinstance(result.exception, OutputError)
    assert 'no directory' in str(result.exception)
    assert not list(tmp_path.iterdir())


def test_bag_given_twice_is_said_to_count_twice(kapitsa):
    bag = resource_path('bags', 'run_01_2240rpm')
    assert 'run_01_2240rpm is given more than once' in kapitsa('analyse', bag, bag, '--json').err
    assert not kapitsa('analyse', bag, '--json').err
    late = kapitsa('replay', bag, bag, '--start', '9e6')
    assert late.status == 2
    assert 'run_01_2240rpm is given more than once' in late.err


def test_bag_that_is_none_is_refused_before_anything_is_written(tmp_path):
    output = tmp_path / 'report.html'
    result = CliRunner().invoke(report, [str(tmp_path), '--output', str(output)])
    assert isinstance(result.exception, BagError)
    assert not output.exists()


def test_the_command_offers_the_formats_that_there_are():
    (option,) = (each for each in report.params if each.name == 'kind')
    assert set(option.type.choices) == set(WRITERS)
