"""Recorded runs in a browser, and what the page is given of them."""

import json
import shutil
import struct
import subprocess
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kapitsa_ros.laboratory.bag_analysis import analyse_bags
from kapitsa_ros.recording.reader import RunBag

pytest.importorskip('starlette')
pytest.importorskip('uvicorn')
from kapitsa_ros.web.errors import PageRequestError
from kapitsa_ros.web.recorded_runs import RecordedRuns

SHIPPED = Path(__file__).parents[2] / 'bags'
HEADER = struct.Struct('<IIddI')
pytestmark = pytest.mark.xdist_group('web')


def frames(content: bytes) -> Iterator[tuple[float, Any, Any, Any, Any]]:
    """Take frames apart: start, angles, heights, times of the flashes, heights of the mark."""
    at = 0
    while at < len(content):
        _, samples, start, _, flashes = HEADER.unpack_from(content, at)
        floats = np.frombuffer(content, '<f4', 2 * (samples + flashes), at + HEADER.size)
        yield start, *np.split(floats, [samples, 2 * samples, 2 * samples + flashes])
        at += HEADER.size + floats.nbytes


def test_the_motion_is_that_of_the_bag_wherever_one_looks() -> None:
    runs, bag = RecordedRuns([SHIPPED / 'run_01_2240rpm']), RunBag(SHIPPED / 'run_01_2240rpm')
    for begin in (0, 100, 150):
        found = list(frames(runs.motion(0, begin, 50, 0.0)))
        assert [start for start, *_ in found] == pytest.approx(0.1 * np.arange(begin, min(begin + 50, 155)))
        joined = np.concatenate([angle[1:] for _, angle, *_ in found])
        assert joined == pytest.approx(bag.motion.angle[100 * begin + 1 :][: joined.size], abs=1e-7)


def test_the_lamp_of_a_replay_freezes_the_mark_twice_at_twice_the_speed() -> None:
    runs = RecordedRuns([SHIPPED / 'run_01_2240rpm'])
    pieces = [frame for begin in (100, 120) for frame in frames(runs.motion(0, begin, 20, 4480.0))]
    times = np.concatenate([start + each.astype(float) for start, _, _, each, _ in pieces])
    marks = np.concatenate([each for *_, each in pieces])
    assert np.diff(times) == pytest.approx(60 / 4480, abs=1e-6)  # across the pieces, too
    assert np.ptp(marks[::2]) < 0.01
    assert np.ptp(marks[1::2]) < 0.01
    assert marks[::2].mean() == pytest.approx(-marks[1::2].mean(), abs=0.01)


@pytest.mark.parametrize('asked', [(1, 0, 1, 0.0), (-1, 0, 1, 0.0), (0, -1, 1, 0.0), (0, 0, 101, 0.0), (0, 0, 0, 0.0)])
def test_no_other_run_and_no_more_than_a_piece_is_given(asked: tuple[int, int, int, float]) -> None:
    with pytest.raises(PageRequestError):
        RecordedRuns([SHIPPED / 'run_01_2240rpm']).motion(*asked)


@pytest.fixture(scope='module')
def replay(serving: Callable[..., Any], tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A replay of a whole run, of one that was cut off, and of a third."""
    folder = tmp_path_factory.mktemp('replay')
    for bag in SHIPPED.iterdir():
        shutil.copytree(bag, folder / bag.name)
    [cut] = (folder / 'run_02_2640rpm').glob('*.mcap')
    cut.write_bytes(cut.read_bytes()[: cut.stat().st_size // 2])
    return serving(folder, 'replay', 'replay', '--web', '--no-open', '--start-paused', folder, stderr=subprocess.PIPE)


def test_what_is_missing_is_said_and_the_fit_is_that_of_analyse(replay: Any) -> None:
    told = json.loads(replay.get('runs.json')[1])
    analysed = analyse_bags(sorted(replay.folder.iterdir()))
    assert [run['defects'] for run in told['runs']] == [run['defects'] for run in analysed['runs']]
    assert [run['complete'] for run in told['runs']] == [True, False, True]
    assert [run['period_s'] for run in told['runs']] == [run['period_s'] for run in analysed['runs']]
    fit = json.loads(replay.get('fit.json')[1])
    assert fit['omega_crit_rpm'] == analysed['omega_crit_rpm']
    assert fit['interval_rpm'] == analysed['omega_crit_interval_rpm']
    assert replay.get('motion?run=0&from=0&count=9999')[0] == 400
    assert replay.get('motion?run=../../etc/passwd&from=0&count=1')[0] == 400
    assert replay.get('runs.json', Origin='http://evil.example')[0] == 403


@pytest.mark.skipif(shutil.which('chromium') is None, reason='no chromium here: apt install chromium')
def test_a_run_is_scrubbed_stepped_and_played_in_the_page(replay: Any) -> None:
    playwright = pytest.importorskip('playwright.sync_api', reason='the browser tests need playwright: make setup')
    seen = RunBag(SHIPPED / 'run_01_2240rpm').motion.angle[11_400]
    with playwright.sync_playwright() as started:
        options = ('--no-sandbox', '--disable-background-networking', '--disable-component-update', '--disable-sync')
        page = started.chromium.launch(executable_path=shutil.which('chromium'), args=list(options)).new_page()
        wrong: list[str] = []
        asked: list[str] = []
        page.on('pageerror', lambda error: wrong.append(str(error)))
        page.on('request', lambda request: asked.append(request.url))
        loading: list[Any] = []
        page.route('**/runs.json*', lambda route: loading.append(route))  # noqa: PLW0108  # Playwright marks it
        with page.expect_request('**/runs.json*'):
            page.goto(replay.url, wait_until='commit')
        for name in ('place', 'pause', 'back', 'step', 'pace', 'run', 'describe', 'dial', 'images'):
            playwright.expect(page.get_by_test_id(name)).to_be_disabled()  # there is nothing to play yet
        loading[0].continue_()
        status = page.get_by_test_id('status')
        playwright.expect(status).to_contain_text('run_01_2240rpm · 0.0 of 15.5 s')
        playwright.expect(status).to_contain_text('0 RPM asked for')
        held: list[Any] = []
        released = threading.Event()
        page.route('**/motion?*', lambda route: route.continue_() if released.is_set() else held.append(route))
        page.get_by_test_id('place').fill('11.3')
        playwright.expect(status).to_contain_text('11.3 of 15.5 s · is being loaded')  # no angle of another time
        page.get_by_test_id('describe').click()
        playwright.expect(page.get_by_test_id('said')).to_contain_text('is being loaded')
        released.set()
        for route in held:
            route.continue_()
        playwright.expect(status).to_contain_text('11.3 of 15.5 s · 2240 RPM')
        page.get_by_test_id('place').blur()
        page.keyboard.press('ArrowRight')
        playwright.expect(status).to_contain_text('11.4 of')
        page.wait_for_function('() => Number(document.documentElement.dataset.frames) > 3')
        page.get_by_test_id('describe').click()
        playwright.expect(page.get_by_test_id('said')).to_contain_text(f'the rod is at {seen:.2f} rad')
        playwright.expect(page.get_by_test_id('warnings')).to_contain_text('run_02_2640rpm: ')
        playwright.expect(page.get_by_test_id('runs')).to_contain_text('cut off')
        playwright.expect(page.get_by_test_id('fit')).to_contain_text('95 % interval')
        page.keyboard.press('n')
        for _ in range(5):
            page.keyboard.press('>')
        page.keyboard.press('Space')
        playwright.expect(status).to_contain_text('run_03_2780rpm')  # it plays on into the next
        assert not wrong
        assert [url for url in asked if not url.startswith(replay.url)] == []
