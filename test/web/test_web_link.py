"""The server of a bench, talked to without a browser."""

import os
import signal
import socket
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip('starlette')
pytest.importorskip('uvicorn')
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.recording.reader import RunBag

PATIENCE = 180.0
pytestmark = pytest.mark.xdist_group('web')


@pytest.fixture
def page(bench: Any, link_to: Callable[..., Any]) -> Any:
    """The page that works the bench."""
    bench.wait()
    page = link_to(bench, 'one')
    page.until(page.works)
    return page


def test_the_bench_is_worked_through_the_link(page: Any) -> None:
    page.ask('pace', 4)
    page.ask('speed', '37.5Hz')
    page.until(lambda: page.told['knobs']['speed'] == pytest.approx(2250))
    page.ask('images', 2)
    page.ask('dial', 4480)
    page.until(lambda: page.told['knobs']['forcing'] == pytest.approx(2240))
    before = page.motions
    page.until(lambda: page.motions > before + 5)
    page.ask('pause')
    page.until(lambda: page.told['rig']['paused'])
    page.ask('pause')
    page.until(lambda: not page.told['rig']['paused'])


@pytest.mark.parametrize(
    ('name', 'value', 'why'),
    [
        ('speed', 'nan', 'the jigsaw does'),
        ('speed', 9000, '5000 RPM'),
        ('speed', -1, 'a speed of -1 RPM'),
        ('speed', '<b>', "'<b>' is not"),
        ('dial', 'nan', 'give a number'),
        ('angle', 3.0, 'quarter turn'),
        ('images', 0, 'a count from 1'),
        ('swings', 10_000, 'a count from 1'),
        ('watch', 'soon', 'needs a number'),
        ('watch', -1, 'not timed: pressed at -1.0 s'),
        ('watch', 1e6, 'not timed: pressed at 1000000.0 s'),
    ],
)
def test_what_cannot_be_done_is_refused_with_its_reason(page: Any, name: str, value: Any, why: str) -> None:
    knobs = dict(page.told['knobs'])
    page.ask(name, value)
    page.refused(why)
    assert {each: page.told['knobs'][each] for each in ('speed', 'dial', 'angle')} == {
        each: knobs[each] for each in ('speed', 'dial', 'angle')
    }


def test_what_a_page_shows_late_is_timed_as_it_was_seen(page: Any) -> None:
    page.ask('pace', 8)
    page.until(lambda: page.motions > 60)
    page.ask('watch', 1.0)
    page.until(lambda: page.told['knobs']['watch_started'] == 1.0)
    page.ask('watch', 0.5)
    page.refused('the watch was started after that')
    page.ask('watch', 2.83)
    page.until(lambda: page.told['knobs']['watch_shown'] == pytest.approx(1.83))


def test_what_the_rig_read_is_told_when_it_is_asked_for(page: Any) -> None:
    run = page.told['rig']['run']
    page.ask('next-run')
    page.until(lambda: f'run {run} is over' in page.told.get('messages', {}).get('messages', []))
    assert 'the rig read' not in str(page.told['messages'])
    page.ask('rig-readings')
    page.until(lambda: f'run {run} is over; the rig read' in str(page.told['messages']))
    page.ask('rig-readings')
    page.until(lambda: 'the rig read' not in str(page.told['messages']) and page.told['rig']['run'] == run + 1)


def test_looks_at_the_plot_are_noted_once_a_run_and_orders_in_haste_count_one_after_the_other(page: Any) -> None:
    for _ in range(6):
        page.ask('look')
    page.ask('images', 3)
    page.until(lambda: page.told['knobs']['images'] == 3)

    def noted() -> int:
        lines = page.told.get('book', {}).get('lines', [])
        return sum(f'run {page.told["rig"]["run"]}, ' in line.get('note', '') for line in lines)

    page.until(noted)
    assert noted() == 1
    page.ask('pause')
    page.ask('pause')
    run = page.told['rig']['run']
    page.ask('next-run')  # after both
    page.until(lambda: page.told['rig']['run'] == run + 1 and not page.told['rig']['paused'])
    assert 'paused already' not in str(page.told['messages'])


def test_frames_that_are_no_requests_are_refused(page: Any) -> None:
    page.link.send('{"do": "dial", "value": NaN}')
    page.refused('NaN is no number')
    page.link.send(b'\0\1\2')
    assert page.closed() == (1003, 'requests are text: one JSON object a frame')


def test_a_frame_that_is_too_long_ends_the_link(bench: Any, page: Any, link_to: Callable[..., Any]) -> None:
    page.link.send('"' + 2000 * 'x' + '"')
    assert page.closed()[0] == 1009
    second = link_to(bench, 'one')
    second.until(second.works)
    with suppress(ConnectionClosed):  # before all of it was sent: then the reason may be lost
        second.link.send('"' + 10_000_000 * 'x' + '"')
    with pytest.raises(ConnectionClosed):
        second.until(lambda: False)
    assert bench.get('health')[0] == 200


def test_a_thousand_requests_at_once_are_bounded(page: Any) -> None:
    for _ in range(300):
        page.ask('touch', 1)
    page.refused('more than 50 requests a second')
    with suppress(ConnectionClosed):
        for _ in range(100_000):
            page.ask('touch', 1)
    assert page.closed()[0] == 1008


def test_a_second_page_watches(bench: Any, page: Any, link_to: Callable[..., Any]) -> None:
    second = link_to(bench, 'two')
    second.until(lambda: 'rig' in second.told and second.motions > 2)
    assert not second.works()
    second.ask('speed', 1000)
    second.refused('another page works this bench')
    second.close()
    assert page.works()


def test_after_a_lost_link_run_and_book_are_the_same(bench: Any, page: Any, link_to: Callable[..., Any]) -> None:
    page.ask('angle', 0.2)
    page.until(lambda: page.told['knobs']['angle'] == 0.2)
    run = page.told['rig']['run']
    page.close()
    again = link_to(bench, 'one')
    again.until(lambda: again.works() and 'knobs' in again.told and 'book' in again.told)
    assert (again.told['rig']['run'], again.told['knobs']['angle']) == (run, 0.2)
    assert again.told['book'] == page.told['book']
    again.close()


def test_a_page_that_comes_back_before_its_lost_link_is_noticed_works(bench: Any, link_to: Callable[..., Any]) -> None:
    lost = link_to(bench, 'three', load='first')
    lost.until(lambda: 'rig' in lost.told and lost.works())
    again = link_to(bench, 'three', load='first')
    again.until(lambda: again.told.get('rig') and again.works())
    again.ask('angle', 0.3)
    again.until(lambda: again.told['knobs']['angle'] == 0.3)
    lost.until(lambda: not lost.works())
    for page in (lost, again):
        page.close()


@pytest.mark.parametrize('headers', [{'Origin': 'http://evil.example'}, {'Host': 'evil.example'}])
def test_a_forged_origin_or_name_is_refused(bench: Any, headers: dict[str, str]) -> None:
    origin, host = headers.get('Origin'), headers.get('Host')
    assert bench.get('', **headers)[0] == 403
    if host:
        return
    with pytest.raises(InvalidStatus) as refused:
        connect(bench.link, origin=origin)
    assert refused.value.response.status_code == 403
    assert b'another page' in refused.value.response.body


def test_no_path_leads_to_a_file(bench: Any) -> None:
    for path in (
        'static/../server.py',
        'static/%2e%2e/server.py',
        'static//etc/passwd',
        'static/index.html',
        'words/de.json',
    ):
        assert bench.get(path)[0] == 404, path
    status, book = bench.get('book.csv')
    assert (status, book.splitlines()[0].split(',')[:2]) == (200, ['forcing_rpm', 'period_s'])


def test_a_client_that_stops_reading_holds_nobody_up(bench: Any, page: Any) -> None:
    deaf = socket.create_connection(('127.0.0.1', int(bench.url.rsplit(':', 1)[1].strip('/'))))
    deaf.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    deaf.sendall(
        (
            f'GET /bench?key=deaf HTTP/1.1\r\nHost: {bench.url[7:-1]}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n'
            'Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n'
        ).encode()
    )
    page.ask('pace', 32)
    seen = page.motions
    page.until(lambda: page.motions > seen + 400)
    page.ask('pace', 1)
    deaf.close()


def test_a_node_that_dies_is_named_and_the_next_run_has_the_speed_that_was_set(
    bench: Any, page: Any, processes_of: Callable[[int], dict[str, int]]
) -> None:
    page.ask('speed', 2000)
    page.until(lambda: page.told['knobs']['speed'] == 2000)
    run = page.told['rig']['run']
    runs = bench.folder / 'runs'
    page.until(lambda: seed_of_first_run(runs))
    os.kill(processes_of(bench.process.pid)['stopwatch'], signal.SIGKILL)
    page.until(lambda: page.told['rig']['failure'])
    assert 'stopwatch was killed by SIGKILL' in page.told['rig']['failure']
    page.ask('speed', 1000)
    page.refused('there is no rig')
    assert bench.get('health')[0] == 503
    page.ask('repair')
    page.until(lambda: page.told['rig']['runs'])
    assert (page.told['rig']['run'], page.told['rig']['failure']) == (run + 1, None)
    assert page.told['knobs']['speed'] == 2000
    page.until(lambda: seed_of_first_run(runs / 'rig_2'))
    assert seed_of_first_run(runs) != seed_of_first_run(runs / 'rig_2'), 'instruments would draw the same once more'


def seed_of_first_run(folder: Path) -> int | None:
    try:
        return int(RunBag(next(folder.glob('run_01_*'))).run.settings['strobe']['seed'])
    except (KapitsaError, StopIteration):  # not on disk yet
        return None
