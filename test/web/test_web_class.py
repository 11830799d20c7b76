"""A class: what its file may say, what students and the teacher reach, and what outlives the server."""

import asyncio
import csv
import io
import json
import resource
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kapitsa_ros.bench.notebook import Notebook, Row, WrittenRow
from kapitsa_ros.configuration.class_settings import load_class
from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig.errors import UsageError

pytest.importorskip('starlette')
pytest.importorskip('uvicorn')
from kapitsa_ros.web.class_folder import ClassFolder, alone_in
from kapitsa_ros.web.class_tables import class_csv
from kapitsa_ros.web.classroom import Classroom
from kapitsa_ros.web.errors import PageRequestError
from kapitsa_ros.web.hand_in import parse_hand_in
from kapitsa_ros.web.page_client import PageClient
from kapitsa_ros.web.student_bench import SLEEP_AFTER, STEPS, StudentBench

pytestmark = pytest.mark.xdist_group('web')
TWO = """
benches: 2
seed: 7
ruler_error: 0.5 mm
instruments: ideal
rods:
  length: {from: 9 in, to: 11 in}
  amplitude: {from: 0.45 in, to: 0.55 in}
  damping: 0.02
"""


def written(folder: Path, text: str) -> Path:
    path = folder / 'class.yaml'
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ('text', 'why'),
    [
        ('benchs: 3', 'no key benchs: give some of benches, seed'),
        ('rods: {lenght: 0.2}', 'rods: no parameter lenght: give some of length'),
        ('benches: 0', r'benches is 0: it must lie in \[1, 99\]'),
        ('rods: {length: {from: 0.3, to: 0.2}}', 'length: empty, from 0.3 to 0.2'),
        ('rods: {length: {from: 0.3}}', 'an interval is written'),
        ('rods: {length: {from: -1, to: 2}}', 'length is -1'),
        ('rods: {clearance: 0.02}', 'below failure_clearance'),
        ('rods: 3', 'give names and values'),
        ('preset: perpetuum', "no preset 'perpetuum'"),
        ('- 3', 'give names and values'),
    ],
)
def test_a_class_file_that_is_wrong_is_refused_in_one_line(tmp_path: Path, text: str, why: str) -> None:
    with pytest.raises(ConfigurationError, match=why) as refused:
        load_class(written(tmp_path, text))
    assert str(refused.value).startswith(str(tmp_path / 'class.yaml'))
    assert '\n' not in str(refused.value)


@pytest.mark.parametrize('file', ['class.json', 'bench_01/bench.json'])
@pytest.mark.parametrize('content', ['', '[]', '{}', '{"colour": 1}'])
def test_a_damaged_file_of_a_class_is_named(tmp_path: Path, file: str, content: str) -> None:
    settings = load_class(written(tmp_path, TWO))
    ClassFolder(tmp_path / 'class', settings)
    (tmp_path / 'class' / file).write_text(content)
    with pytest.raises(UsageError, match=file):
        [bench.record() for bench in ClassFolder(tmp_path / 'class', settings).benches]


def test_rods_are_drawn_from_the_seed_each_its_own(tmp_path: Path) -> None:
    settings = load_class(written(tmp_path, TWO))
    again = load_class(written(tmp_path, TWO))
    rods = [settings.rod(number) for number in range(1, 100)]
    assert rods == [again.rod(number) for number in range(1, 100)]
    lengths = np.array([rod.plant.length for rod in rods])
    assert np.unique(lengths).size == 99
    assert 0.2286 <= lengths.min() < 0.232
    assert 0.276 < lengths.max() <= 0.2794
    assert {rod.plant.damping for rod in rods} == {0.02}
    errors = np.array([rod.told_length for rod in rods]) - lengths
    assert errors.std() == pytest.approx(0.0005, rel=0.3)  # four standard errors of a standard deviation of 99
    assert settings.told_amplitude == (pytest.approx(0.0127), pytest.approx(0.00254 / 12**0.5))
    other = load_class(written(tmp_path, TWO.replace('seed: 7', 'seed: 8')))
    assert other.rod(1) != settings.rod(1)


def test_a_book_is_gone_on_with_as_it_was(tmp_path: Path) -> None:
    book = Notebook(tmp_path / 'book.csv')
    for run in (1, 2):
        row = Row(run=run, forcing_rpm=2240.0, period_s=1.01, display_s=3.03, swings=3, release_rad=float('nan'))
        book.write_down(row)
    book.note('run 2, 3.0 s: the plot of the angle is looked at')
    book.strike_out(1)
    again = Notebook(tmp_path / 'book.csv', continued=True)
    assert again.text() == book.text()
    assert [isinstance(line, WrittenRow) and line.struck for line in again.lines] == [True, False, False]
    again.strike_out()
    assert (tmp_path / 'book.csv').read_text() == again.text()


def test_another_class_is_not_gone_on_with(tmp_path: Path) -> None:
    settings = load_class(written(tmp_path, TWO))
    first = ClassFolder(tmp_path / 'kept', settings)
    again = ClassFolder(tmp_path / 'kept', settings)
    assert (again.join_code, again.token, again.continued) == (first.join_code, first.token, True)
    assert again.benches[1].sealed() == settings.rod(2).plant
    other = load_class(written(tmp_path, TWO.replace('seed: 7', 'seed: 8')))
    with pytest.raises(UsageError, match='a class with other rods'):
        ClassFolder(tmp_path / 'kept', other)
    with pytest.raises(UsageError, match='holds no class'):
        ClassFolder(tmp_path, settings)
    with alone_in(tmp_path / 'kept'), pytest.raises(UsageError, match='is served already'), alone_in(tmp_path / 'kept'):
        pass
    with alone_in(tmp_path / 'kept'):
        pass
    (tmp_path / 'kept' / 'bench_02' / 'bench.json').write_text('{"key": "a", "role": "teacher"}')
    with pytest.raises(UsageError, match=r'bench\.json: cannot be read'):
        again.benches[1].record()
    secret = [path for path in (tmp_path / 'kept').rglob('*') if path.is_file()]
    assert {path.stat().st_mode & 0o077 for path in secret} == {0}


@pytest.mark.parametrize('values', [(), ('x', 1, 2), (3, 1, 2), ('nan', 'nan', 'nan'), (1e7, 1, 1e9)])
def test_what_is_no_critical_speed_is_not_taken(values: tuple[Any, ...]) -> None:
    with pytest.raises(PageRequestError, match='to hand in'):
        parse_hand_in(dict(zip(('omega_crit_rpm', 'low_rpm', 'high_rpm'), values, strict=False)))


def test_students_join_by_the_code_and_hand_in_against_the_sealed_rod(tmp_path: Path) -> None:
    settings = load_class(written(tmp_path, TWO))

    async def sit() -> list[dict[str, Any]]:
        room = Classroom(settings, ClassFolder(tmp_path / 'kept', settings))
        code = room.folder.join_code
        with pytest.raises(PageRequestError, match='not the code'):
            room.join('aaaa-aaaa', 'Eve')
        ann = room.join(code.upper().replace('-', ' '), ' Ann\n')
        with pytest.raises(PageRequestError, match='taken'):
            room.join(code, 'Ann')
        bob = room.join(code, '=cmd()')
        with pytest.raises(PageRequestError, match='all 2 benches'):
            room.join(code, 'Eve')
        assert (room.bench_of(ann.record.key), room.bench_of('')) == (ann, None)
        truth = await ann.truth()
        assert truth
        ann.hand_in({'omega_crit_rpm': 1, 'low_rpm': 1, 'high_rpm': 2})
        ann.hand_in({'omega_crit_rpm': truth, 'low_rpm': truth - 10, 'high_rpm': truth + 10})
        bob.hand_in({'omega_crit_rpm': 900, 'low_rpm': 800, 'high_rpm': '1000 rpm'})
        rows = await room.rows()
        await room.end()
        return rows

    rows = asyncio.run(sit())
    assert [(row['name'], row['handed_in'], row['covered']) for row in rows] == [('Ann', 2, True), ('=cmd()', 1, False)]
    table = list(csv.DictReader(io.StringIO(class_csv(rows))))
    assert table[1]['name'] == "'=cmd()"
    assert float(table[0]['length_m']) == settings.rod(1).plant.length
    document = pytest.importorskip('kapitsa_ros.reporting.report').class_document
    page = document([row | {'name': row['name'].replace('cmd', '<b>')} for row in rows]).text
    assert '1 of 2 intervals hold' in page
    assert '<b>' not in page


def test_what_a_full_disk_does_not_take_is_refused_with_its_reason(tmp_path: Path) -> None:
    settings = load_class(written(tmp_path, TWO))
    values = {'omega_crit_rpm': 900, 'low_rpm': 800, 'high_rpm': 1000}

    async def sit() -> None:
        room = Classroom(settings, ClassFolder(tmp_path / 'kept', settings))
        ann = room.join(room.folder.join_code, 'Ann')
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (64, hard))
        try:
            with pytest.raises(PageRequestError, match='could not be kept: File too large'):
                ann.hand_in(values)
            with pytest.raises(PageRequestError, match='cannot be given away'):
                room.join(room.folder.join_code, 'Bob')
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        assert not ann.hand_ins
        ann.hand_in(values)
        assert room.join(room.folder.join_code, 'Bob').number == 2
        await room.end()

    asyncio.run(sit())
    assert len(list((tmp_path / 'kept' / 'bench_01').iterdir())) == 3


def test_time_stands_still_where_nobody_looks_and_goes_on_for_who_comes_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = load_class(written(tmp_path, TWO))

    class Controls:
        """Of a rig that does at once what it is told."""

        def toggle_pause(self) -> None:
            bench.state.set_paused(paused=not bench.state.paused)

    async def sit() -> StudentBench:
        return Classroom(settings, ClassFolder(tmp_path / 'kept', settings)).benches[0]

    bench = asyncio.run(sit())
    monkeypatch.setattr(StudentBench, 'runs', True)
    bench.controls = Controls()
    page, now = PageClient('a', 'load', 'en'), time.monotonic()
    stands_still = []
    for moment in (0.0, SLEEP_AFTER - 1.0, SLEEP_AFTER + 1.0, SLEEP_AFTER + 2.0):
        bench.look_after(now + moment)
        stands_still.append(bench.state.paused)
    assert stands_still == [False, False, True, True]
    bench.pages.join(page, now)
    bench.look_after(now + 2 * SLEEP_AFTER)
    assert (bench.state.paused, bench.asleep) == (False, False)
    bench.controls.toggle_pause()  # by the student
    bench.pages.leave(page, now)
    for moment in (2.5, 9.0):
        bench.look_after(now + moment * SLEEP_AFTER)
    bench.pages.join(page, now)
    bench.look_after(now + 10 * SLEEP_AFTER)
    assert bench.state.paused  # who has paused it finds it so


@pytest.mark.slow
@pytest.mark.skipif(shutil.which('chromium') is None, reason='no chromium here: apt install chromium')
@pytest.mark.parametrize(('width', 'scheme'), [(1280, 'light'), (768, 'dark'), (390, 'dark')])
def test_a_student_joins_and_hands_in_and_the_teacher_sees_it_in_the_browser(
    serving: Callable[..., Any], tmp_path: Path, width: int, scheme: str
) -> None:
    playwright = pytest.importorskip('playwright.sync_api')
    axe = pytest.importorskip('axe_playwright_python.sync_playwright').Axe()
    server = serving(
        tmp_path, 'class', 'serve', '--no-open', '--class', written(tmp_path, TWO), '--bags', tmp_path / 'kept'
    )
    token = json.loads((tmp_path / 'kept' / 'class.json').read_text())['token']
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=shutil.which('chromium'), args=['--no-sandbox'])
        context = browser.new_context(viewport={'width': width, 'height': 800}, color_scheme=scheme)
        pages = [context.new_page() for _ in range(2)]
        student, teacher = pages
        wrong: list[str] = []
        for page in pages:
            page.set_default_timeout(60_000)
            page.on('pageerror', lambda error: wrong.append(str(error)))
        student.goto(server.url)
        student.get_by_label('Your name').fill('<b>Ann</b>')
        student.keyboard.press('Enter')
        student.get_by_test_id('omega-crit').fill('1500')
        student.get_by_test_id('low').fill('1600')
        student.get_by_test_id('high').fill('1700')
        student.keyboard.press('Enter')
        playwright.expect(student.get_by_test_id('said')).to_contain_text('the interval must hold')
        student.get_by_test_id('low').fill('1400')
        student.keyboard.press('Enter')
        playwright.expect(student.get_by_test_id('handed-in')).to_contain_text('1400 to 1700')
        teacher.goto(f'{server.url.partition("?")[0]}teacher?token={token}')
        playwright.expect(teacher.get_by_test_id('benches')).to_contain_text('<b>Ann</b>')
        playwright.expect(teacher.get_by_test_id('coverage')).to_contain_text('1 of 1 have handed in')
        student.goto(server.url)
        student.get_by_text('Back to the bench').click()
        playwright.expect(student.get_by_test_id('handed-in')).to_contain_text('1400 to 1700')
        for page in pages:
            found = axe.run(page).response['violations']
            assert [each['id'] for each in found if each['impact'] in {'serious', 'critical'}] == []
            assert page.evaluate('() => document.documentElement.scrollWidth') <= width
        assert not wrong
        browser.close()


def work(page: Any, speed: int) -> None:
    """Set the speed, time something, write it down and hand in."""
    page.until(lambda: page.told.get('rig', {}).get('runs'))
    page.ask('pace', 8)
    page.ask('speed', speed)
    page.ask('dial', 2 * speed)
    page.until(lambda: page.motions > 10)
    page.ask('watch', STEPS.step * page.motions)
    page.until(lambda: page.told['knobs']['watch_started'] is not None)
    begun = page.motions
    page.until(lambda: page.motions > begun + 20)
    page.ask('watch', STEPS.step * page.motions)
    page.ask('write')
    page.until(lambda: page.told['book']['lines'])
    page.ask('hand-in', {'omega_crit_rpm': 1500, 'low_rpm': 1400, 'high_rpm': 1600})
    page.until(lambda: page.told['class']['handed_in'] == 1)


def join(server: Any, name: str) -> str:
    """Join the class; return the key of the bench."""
    code = server.url.partition('join=')[2]
    status, answer = server.ask('join', 'POST', json.dumps({'code': code, 'name': name}))
    assert status == 200
    key: str = json.loads(answer)['link'].partition('=')[2]
    return key


def test_a_class_outlives_its_server(serving: Callable[..., Any], link_to: Callable[..., Any], tmp_path: Path) -> None:
    kept = tmp_path / 'kept'
    command = ['serve', '--no-open', '--class', written(tmp_path, TWO), '--bags', kept]
    server = serving(tmp_path, 'class', *command)
    keys = [join(server, name) for name in ('Ann', 'Bob')]
    pages = [link_to(server, 'page', bench=key) for key in keys]
    for page, speed in zip(pages, (2200, 2500), strict=True):
        work(page, speed)
    refuse_strangers(server)
    told = json.dumps([page.told for page in pages])
    for number in (1, 2):
        sealed = load_class(tmp_path / 'class.yaml').rod(number).plant
        assert str(sealed.length) not in told
        assert str(sealed.amplitude) not in told
    written_down = server.get(f'book.csv?bench={keys[0]}')[1].splitlines()
    server.process.kill()
    server.process.wait()
    again = serving(tmp_path, 'class', *command)
    assert again.url.partition('?')[2] == server.url.partition('?')[2]
    page = link_to(again, 'other', bench=keys[0])
    page.until(lambda: 'class' in page.told)
    assert 'the server was ended in run 1' in page.told['rig']['failure']
    *book, note = again.get(f'book.csv?bench={keys[0]}')[1].splitlines()
    assert book == written_down
    assert note.startswith('# run 1 was cut off')
    assert (page.told['class']['handed_in'], page.told['knobs']['speed']) == (1, 2200)
    runs = kept / 'bench_01' / 'runs'
    [cut] = map(RunBag, runs.glob('run_01_*'))
    assert not cut.complete
    assert cut.steps > 20
    page.ask('repair')
    page.until(lambda: page.told['rig']['runs'])
    assert (page.told['rig']['run'], page.told['knobs']['speed']) == (2, 2200)
    token = json.loads((kept / 'class.json').read_text())['token']
    benches = json.loads(again.get(f'teacher.json?token={token}')[1])['benches']
    told_teacher = [(bench['name'], bench['readings'], bench['omega_crit_rpm']) for bench in benches]
    assert told_teacher == [('Ann', 1, 1500), ('Bob', 1, 1500)]
    page.until(lambda: page.motions > 5)
    second = link_to(again, 'another', bench=keys[0])  # no second rig is started for it
    second.until(lambda: second.motions > 5)
    assert (second.told['rig']['run'], second.told['rig']['failure']) == (2, None)
    assert '2 of 2 have handed in' in again.end()
    assert all(RunBag(bag).complete for bag in (runs / 'rig_2').glob('run_01_*'))


def refuse_strangers(server: Any) -> None:
    """Nobody without a key or the teacher's token gets anything."""
    paths = ['student?bench=x', 'book.csv', 'teacher?token=x', 'teacher.json', 'class.csv', 'books.csv', 'report.html']
    assert {server.get(path)[0] for path in paths} == {403}
    assert server.ask('join', 'POST', '[' * 3000)[0] == 403
    assert server.get('', Origin='http://evil.example')[0] == 403
