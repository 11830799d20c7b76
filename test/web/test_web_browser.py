"""The bench in Chromium, worked by keyboard and mouse: one rig for all tests, in the order in which they stand."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kapitsa_ros.configuration.tables import read_timings
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.units import RPM
from kapitsa_ros.web.bench_setup import STEPS

pytest.importorskip('starlette')
playwright = pytest.importorskip('playwright.sync_api', reason='the browser tests need playwright: make setup')

CHROMIUM = next(filter(None, map(shutil.which, ('chromium', 'chromium-browser', 'google-chrome'))), None)
OFFLINE = (
    '--no-sandbox',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
    '--no-first-run',
)
PATIENCE = 180_000
SPEEDS = {2240: 12, 2640: 10, 2780: 9}
"""RPM, and steps of the rig that four swings take there, nearly."""
pytestmark = [
    pytest.mark.xdist_group('web'),
    pytest.mark.skipif(CHROMIUM is None, reason='no chromium here: apt install chromium'),
]


@pytest.fixture(scope='module')
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=list(OFFLINE))
        yield browser
        browser.close()


@pytest.fixture
def open_page(bench: Any, browser: Any) -> Iterator[Callable[..., Any]]:
    """Open pages; none of them asks for anything elsewhere, or fails."""
    bench.wait()
    contexts, asked, wrong = [], [], []

    def open_(query: str = '', **options: Any) -> Any:
        context = browser.new_context(
            **({'viewport': {'width': 1000, 'height': 700}, 'reduced_motion': 'reduce'} | options)
        )
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(PATIENCE)
        page.on('request', lambda request: asked.append(request.url))
        page.on('pageerror', lambda error: wrong.append(str(error)))
        page.on('console', lambda line: line.type == 'error' and wrong.append(line.text))
        page.goto(bench.url + query)
        page.wait_for_function('() => Number(document.documentElement.dataset.frames) > 0')
        return page

    yield open_
    for context in contexts:
        for page in context.pages:  # the bench of the next test runs, however this one ended
            if the(page, 'pause').get_attribute('aria-pressed') == 'true':
                the(page, 'pause').click()
                playwright.expect(the(page, 'pause')).to_have_attribute('aria-pressed', 'false')
        context.close()
    assert asked
    assert [url for url in asked if not url.startswith(bench.url)] == []
    assert wrong == []


def the(page: Any, name: str) -> Any:
    return page.get_by_test_id(name)


def wait_text(page: Any, name: str, text: str) -> None:
    playwright.expect(the(page, name)).to_contain_text(text)


def seconds(page: Any) -> float:
    return float(the(page, 'status').inner_text().split('·')[1].split()[0])


def wait_seconds(page: Any, until: float) -> None:
    page.wait_for_function(
        "until => Number(document.getElementById('status').textContent.split('·')[1].split(' s')[0]) >= until",
        arg=until,
    )


def wait_drawn(page: Any) -> None:
    """Wait until what the page knows is on it."""
    drawn = page.evaluate('() => Number(document.documentElement.dataset.frames)')
    page.evaluate("async () => (await import(new URL('static/page.js', location))).redraw()")
    page.wait_for_function('drawn => Number(document.documentElement.dataset.frames) > drawn', arg=drawn)


def luminance(page: Any, name: str) -> Any:
    """What is drawn on a canvas: its green, (height, width), 0 to 255."""
    shape, values = page.evaluate(
        """(name) => {
            const canvas = document.getElementById(name);
            const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
            return [[canvas.height, canvas.width], Array.from(pixels).filter((_, i) => i % 4 === 1)];
        }""",
        name,
    )
    return np.array(values, dtype=float).reshape(shape)


def images(page: Any) -> int:
    """Count the bright images of the mark, down the middle of the lamp's picture."""
    column = page.evaluate(
        """() => {
            const canvas = document.getElementById('lamp');
            const pixels = canvas.getContext('2d').getImageData(canvas.width / 2, 0, 1, canvas.height).data;
            return Array.from({length: canvas.height}, (_, i) => pixels[4 * i]);
        }"""
    )
    lit = np.array(column) > 100
    return int(np.count_nonzero(np.diff(lit.astype(int)) == 1))


def begin_run(page: Any) -> int:
    run = int(the(page, 'status').inner_text().split()[1])
    page.keyboard.press('x')
    wait_text(page, 'status', f'run {run + 1}')
    return run + 1


def measure(page: Any, rpm: int, steps: int) -> None:
    """Find the speed with the lamp and time four swings, at a rig that is stepped for the watch's sake."""
    the(page, 'pace').select_option('16')
    the(page, 'speed').fill(str(rpm))
    page.keyboard.press('Enter')
    page.keyboard.press('Escape')
    the(page, 'dial').fill(str(2 * rpm - 3))
    page.keyboard.press('Enter')
    page.keyboard.press('Escape')
    wait_text(page, 'dial-reading', str(2 * rpm - 3))
    for _ in range(3):
        page.keyboard.press('ArrowRight')
    wait_text(page, 'forcing', str(rpm))
    wait_seconds(page, seconds(page) + 8.0)
    page.keyboard.press('p')
    wait_text(page, 'pause', 'Go on')
    wait_drawn(page)
    assert images(page) in {1, 2}
    the(page, 'rig').scroll_into_view_if_needed()
    box = the(page, 'rig').bounding_box()  # pulled aside by hand
    page.mouse.move(box['x'] + box['width'] / 2 + 5, box['y'] + 0.3 * box['height'])
    page.mouse.down()
    page.mouse.move(box['x'] + box['width'] / 2 + 20, box['y'] + 0.3 * box['height'])
    page.mouse.up()
    wait_text(page, 'messages', 'released from')
    page.keyboard.press('p')
    wait_text(page, 'pause', 'Pause')
    wait_seconds(page, seconds(page) + 10.0)  # the rig's own stopwatch has its reading too
    page.keyboard.press('p')
    wait_text(page, 'pause', 'Go on')
    wait_drawn(page)
    page.keyboard.press('Space')
    begun = seconds(page)
    for _ in range(steps):
        page.keyboard.press('n')
    wait_seconds(page, round(begun + STEPS.step * steps, 1) - 0.01)
    page.keyboard.press('Space')
    wait_text(page, 'period', f'{steps / 20:.3f} s')
    page.keyboard.press('w')
    wait_text(page, 'messages', 'written down')
    page.keyboard.press('p')
    wait_text(page, 'pause', 'Pause')


def test_a_whole_laboratory_by_keyboard_and_mouse(
    bench: Any, open_page: Callable[..., Any], kapitsa: Callable[..., Any]
) -> None:
    page = open_page()
    runs = []
    the(page, 'swings').fill('4')
    page.keyboard.press('Enter')
    page.keyboard.press('Escape')
    for rpm, steps in SPEEDS.items():
        runs.append(begin_run(page))
        measure(page, rpm, steps)
    last = begin_run(page)
    rows = [row.split('\t')[:5] for row in the(page, 'book').inner_text().splitlines()[1:]]
    assert [row[1:5] for row in rows[-3:]] == [
        [str(run), str(rpm), f'{steps / 20:.3f}', '4'] for run, (rpm, steps) in zip(runs, SPEEDS.items(), strict=True)
    ]
    wait_text(page, 'fit', '95 % interval')
    written = kapitsa('reduce', bench.folder / 'mine.csv', '--json').json
    assert f'{written["omega_crit_rpm"]:.0f} RPM' in the(page, 'fit').inner_text()
    assert bench.get('book.csv')[1] == (bench.folder / 'mine.csv').read_text()
    assert [row.speed / RPM for row in read_timings(bench.folder / 'mine.csv').rows] == pytest.approx(list(SPEEDS))
    bags = [next((bench.folder / 'runs').glob(f'run_{run:02d}_*')) for run in runs]
    assert all(RunBag(bag).complete for bag in bags)
    analysed = kapitsa('analyse', *bags, '--json').json
    read = [(run['speed_reading_rpm'], run['period_s']) for run in analysed['runs']]
    assert [speed for speed, _ in read] == pytest.approx(list(SPEEDS), rel=0.002)
    assert [period for _, period in read] == pytest.approx([steps / 20 for steps in SPEEDS.values()], rel=0.1)
    lines = len(the(page, 'book').inner_text().splitlines())
    page.get_by_role('button', name='strike out line 1').click()
    wait_text(page, 'book', 'struck out')
    assert len(the(page, 'book').inner_text().splitlines()) == lines
    page.reload()  # in mid-run
    page.wait_for_function('() => Number(document.documentElement.dataset.frames) > 0')
    wait_text(page, 'status', f'run {last}')
    wait_text(page, 'book', 'struck out')
    wait_text(page, 'fit', '95 % interval')
    playwright.expect(the(page, 'speed')).to_be_enabled()


def test_what_cannot_be_done_before_a_page_is_loaded_is_seen_to_be(open_page: Callable[..., Any]) -> None:
    page = open_page()
    held: list[Any] = []
    page.route('**/words.json*', lambda route: held.append(route))  # noqa: PLW0108  # Playwright marks its handlers
    with page.expect_request('**/words.json*'):
        page.reload(wait_until='commit')
    for name in ('pause', 'step', 'pace', 'next-run', 'describe', 'speed', 'stopwatch', 'write', 'look'):
        playwright.expect(the(page, name)).to_be_disabled()
    held[0].continue_()
    for name in ('pause', 'pace', 'next-run', 'describe', 'speed', 'stopwatch', 'write', 'look'):
        playwright.expect(the(page, name)).to_be_enabled()


def test_of_two_tabs_the_second_watches(open_page: Callable[..., Any]) -> None:
    first, second = open_page(reduced_motion='no-preference'), open_page()
    wait_text(second, 'status', 'run')
    assert 'Another page works this bench' in second.get_by_role('alert').inner_text()
    playwright.expect(the(second, 'speed')).to_be_disabled()
    playwright.expect(the(first, 'speed')).to_be_enabled()


def test_what_is_refused_is_said_in_sight_and_does_not_stay_in_its_field(open_page: Callable[..., Any]) -> None:
    page = open_page(viewport={'width': 390, 'height': 800})
    playwright.expect(the(page, 'speed')).to_be_enabled()
    wait_text(page, 'status', 'run')
    before = the(page, 'speed').input_value()
    for name, typed, why in (
        ('speed', '9999', 'a speed of 9999 RPM'),
        ('images', '12', 'a count from 1 to 9'),
        ('swings', '2.5', 'needs a whole number'),
    ):
        the(page, name).fill(typed)
        page.keyboard.press('Enter')
        wait_text(page, 'said', why)
        playwright.expect(the(page, 'said')).to_be_in_viewport()
        page.keyboard.press('Escape')
        playwright.expect(the(page, name)).not_to_have_value(typed)
    assert the(page, 'speed').input_value() == before
    page.keyboard.press('c')
    playwright.expect(the(page, 'said')).to_be_empty()


def test_only_who_takes_hold_of_the_rod_and_pulls_lets_it_go(open_page: Callable[..., Any]) -> None:
    page = open_page()
    playwright.expect(the(page, 'pause')).to_be_enabled()
    wait_text(page, 'status', 'run')
    begin_run(page)  # the rod is held upright
    page.keyboard.press('p')
    wait_text(page, 'pause', 'Go on')
    wait_drawn(page)
    the(page, 'rig').scroll_into_view_if_needed()
    box = the(page, 'rig').bounding_box()
    middle, high = box['x'] + box['width'] / 2, box['y'] + 0.4 * box['height']
    page.evaluate(
        """() => {
            window.asked = [];
            WebSocket.prototype.send = (text) => window.asked.push(JSON.parse(text).do);
        }"""
    )
    page.mouse.click(box['x'] + 8, box['y'] + box['height'] - 8)
    page.mouse.click(middle, high)
    assert page.evaluate('() => window.asked') == []
    page.mouse.move(middle, high)
    page.mouse.down()
    page.mouse.move(middle + 30, high)
    page.mouse.up()
    assert page.evaluate('() => window.asked') == ['angle', 'release']
    page.reload()
    playwright.expect(the(page, 'step')).to_be_enabled()
    page.keyboard.press('p')
    wait_text(page, 'pause', 'Pause')


def test_what_an_exposure_shows_is_no_alias(open_page: Callable[..., Any]) -> None:
    page = open_page()
    seen = page.evaluate("""async () => {
        const { Steps } = await import(new URL('static/steps.js', location));
        const steps = new Steps();
        const at = (turn) => Float32Array.from({length: 1001}, (_, i) => turn(i / 1000));
        const height = at((time) => Math.cos(2 * Math.PI * 60 * time));
        steps.steps = [{run: 1, start: 0, end: 1, period: 0.001, angle: at(() => 0), height, times: [], marks: []}];
        return [4, 8, 16, 25].map((pace) => steps.exposure(0.02, 0.02 + pace / 30, 64).map((state) => state.height));
    }""")
    for heights in seen:  # 8, 16, 32 and 50 turns of the shaft
        assert np.histogram(heights, bins=8, range=(-1, 1))[0].min() > 0


def test_a_page_goes_on_with_a_bench_that_was_started_again(
    serving: Callable[..., Any], browser: Any, tmp_path: Path
) -> None:
    command = ['bench', '--web', '--no-open', '--instruments', 'ideal']
    first = serving(tmp_path, 'bench', *command, '--bags', tmp_path / 'a', '--table', tmp_path / 'a.csv')
    page = browser.new_page(locale='en-GB')
    page.set_default_timeout(PATIENCE)
    page.goto(first.url)
    wait_text(page, 'status', 'run 1')
    begin_run(page)
    wait_seconds(page, 0.5)
    first.end()
    port = first.url.rstrip('/').rpartition(':')[2]
    again = serving(tmp_path, 'bench', *command, '--bags', tmp_path / 'b', '--table', tmp_path / 'b.csv', port=port)
    wait_text(page, 'status', 'run 1')
    drawn = page.evaluate('() => Number(document.documentElement.dataset.frames)')
    wait_seconds(page, seconds(page) + 0.5)
    assert page.evaluate('() => Number(document.documentElement.dataset.frames)') > drawn
    page.close()
    again.end()


def test_a_page_on_which_nothing_moves_draws_nothing(open_page: Callable[..., Any]) -> None:
    page = open_page(reduced_motion='no-preference')
    playwright.expect(the(page, 'pause')).to_be_enabled()
    page.keyboard.press('p')
    wait_text(page, 'status', 'paused')
    count = """() => new Promise((done) => {
        const frames = () => document.documentElement.dataset.frames;
        const begun = frames();
        let left = 20;
        const frame = () => (left-- ? requestAnimationFrame(frame) : done(frames() - begun));
        frame();
    })"""
    page.wait_for_function(f'async () => await ({count})() === 0')  # what was in flight has come
    before = luminance(page, 'rig')
    for width in (900, 1000):  # a canvas of another size is drawn again, by itself
        page.set_viewport_size({'width': width, 'height': 700})
        page.wait_for_function(
            "() => Array.from(document.querySelectorAll('#rig, #lamp')).every((one) => one.width === one.clientWidth)"
        )
        page.wait_for_function(f'async () => await ({count})() === 0')
    after = luminance(page, 'rig')
    assert after.shape == before.shape
    ink = np.count_nonzero(np.abs(before - np.median(before)) > 32)
    # The letters may come out smoother or rougher: Chromium takes another rasteriser after a canvas was read.
    assert np.count_nonzero(np.abs(after - before) > 32) < 0.1 * ink


def test_the_angle_is_drawn_only_for_who_takes_the_blindfold_off(bench: Any, open_page: Callable[..., Any]) -> None:
    page = open_page()
    playwright.expect(the(page, 'angle-plot')).to_be_hidden()
    assert the(page, 'rig-readings').inner_text() == ''
    the(page, 'look').click()
    playwright.expect(the(page, 'angle-plot')).to_be_visible()
    wait_text(page, 'book', 'the plot of the angle is looked at')
    assert '# run ' in (bench.folder / 'mine.csv').read_text()
    the(page, 'look').click()
    playwright.expect(the(page, 'angle-plot')).to_be_hidden()
    the(page, 'look').click()
    playwright.expect(the(page, 'angle-plot')).to_be_visible()
    begin_run(page)  # of which the book has no note
    playwright.expect(the(page, 'angle-plot')).to_be_hidden()


@pytest.mark.parametrize('width', [390, pytest.param(768, marks=pytest.mark.slow)])
def test_narrow_screens_do_not_scroll_sideways(open_page: Callable[..., Any], width: int) -> None:
    page = open_page(viewport={'width': width, 'height': 800}, has_touch=True)
    assert page.evaluate('() => document.documentElement.scrollWidth') <= width
    the(page, 'stopwatch').tap()
    page.wait_for_function("() => Number(document.getElementById('stopwatch').textContent) > 0.2")
    the(page, 'stopwatch').tap()
    wait_text(page, 'period', '→')
    the(page, 'clear').tap()


def test_the_page_speaks_the_language_of_the_browser(open_page: Callable[..., Any]) -> None:
    page = open_page(locale='de-DE')
    assert page.get_attribute('html', 'lang') == 'de'
    wait_text(page, 'pause', 'Anhalten')
    wait_text(page, 'messages', 'die Welle ruht')
    the(page, 'speed').fill('1.353')
    page.keyboard.press('Enter')
    wait_text(page, 'said', '1353 oder 1,353')
    page.keyboard.press('Escape')
    playwright.expect(the(page, 'speed')).not_to_have_value('1.353')
    page.keyboard.press('c')
    playwright.expect(the(page, 'said')).to_be_empty()
    assert open_page('?lang=en', locale='de-DE').get_attribute('html', 'lang') == 'en'


@pytest.mark.parametrize('scheme', [pytest.param('light', marks=pytest.mark.slow), 'dark'])
def test_nothing_serious_stands_in_the_way_of_anyone(open_page: Callable[..., Any], scheme: str) -> None:
    axe = pytest.importorskip('axe_playwright_python.sync_playwright').Axe()
    page = open_page(color_scheme=scheme)
    page.locator('summary').click()
    found = axe.run(page).response['violations']
    assert [(each['id'], each['nodes'][0]['html']) for each in found if each['impact'] in {'serious', 'critical'}] == []


def test_a_screen_reader_is_told_states_and_readings(open_page: Callable[..., Any]) -> None:
    page = open_page()
    playwright.expect(the(page, 'pause')).to_be_enabled()
    names = {'Speed of the shaft, RPM', 'Dial of the lamp, flashes a minute', 'Release angle, rad'}
    for name in names:
        assert page.get_by_role('textbox', name=name).count() == 1
    assert page.get_by_role('log').get_attribute('aria-live') == 'polite'
    page.keyboard.press('v')
    page.wait_for_function("() => /the rod (is at|lies)/.test(document.getElementById('said').textContent)")
    order = []
    for _ in range(12):
        page.keyboard.press('Tab')
        order.append(page.evaluate('() => document.activeElement.id'))
    assert [name for name in order if name][:4] == ['pause', 'pace', 'next-run', 'describe']
