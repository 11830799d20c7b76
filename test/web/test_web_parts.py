"""The bench in a browser without a server: requests, limits, pages, words, files."""

import ast
import asyncio
import json
import pickle
import re
import string
import struct
from pathlib import Path

import numpy as np
import pytest

from kapitsa_ros.analysis.table import Readings, refuse_mixed_units
from kapitsa_ros.analysis.timing_row import TimingRow
from kapitsa_ros.errors import KapitsaError, QuantityError, said_of
from kapitsa_ros.instruments.lamp import Lamp
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.message import Message, said_by
from kapitsa_ros.operator.requests import check_speed
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.rig.errors import RigError
from kapitsa_ros.units import RPM, parse_speed
from kapitsa_ros.web.access import Access
from kapitsa_ros.web.book_fit import BookFit
from kapitsa_ros.web.catalogue import choose_language, languages, translated, words_of
from kapitsa_ros.web.errors import PageRequestError
from kapitsa_ros.web.motion_frame import encode_motion
from kapitsa_ros.web.page_client import PageClient
from kapitsa_ros.web.page_clients import MOST_PAGES, PageClients
from kapitsa_ros.web.protocol import PageRequest, parse_request
from kapitsa_ros.web.request_limit import RequestLimit

PACKAGE = Path(__file__).parents[2] / 'kapitsa_ros'
STATIC = PACKAGE / 'web' / 'static'


@pytest.mark.parametrize(
    ('frame', 'request_'),
    [
        ('{"do": "speed", "value": 2240}', PageRequest('speed', 2240)),
        ('{"do": "speed", "value": " 37.3Hz "}', PageRequest('speed', '37.3Hz')),
        ('{"do": "release"}', PageRequest('release')),
        ('{"do": "images", "value": 2}', PageRequest('images', 2)),
    ],
)
def test_requests_are_understood(frame: str, request_: PageRequest) -> None:
    assert parse_request(frame) == request_


@pytest.mark.parametrize(
    ('frame', 'why'),
    [
        ('', 'a JSON object'),
        ('[1]', 'a JSON object'),
        ('[' * 100_000, 'a JSON object'),
        ('{"do": 3}', 'a JSON object'),
        ('{"do": "explode"}', "no request 'explode'"),
        ('{"do": "dial", "value": NaN}', 'NaN is no number'),
        ('{"do": "dial", "value": -Infinity}', '-Infinity is no number'),
        ('{"do": "dial", "value": 1e999}', 'no number that can be meant'),
        ('{"do": "dial", "value": true}', 'needs a number'),
        ('{"do": "dial"}', 'needs a number'),
        ('{"do": "images", "value": 2.5}', 'needs a whole number'),
        ('{"do": "release", "value": 1}', 'takes no value'),
        ('{"do": "speed", "value": "' + '9' * 50 + '"}', 'longer than 40'),
        ('{"do": "pause", "path": "/etc/passwd"}', "'path' is not understood"),
    ],
)
def test_what_is_no_request_is_refused_with_its_reason(frame: str, why: str) -> None:
    with pytest.raises(PageRequestError, match=re.escape(why)):
        parse_request(frame)


def test_requests_are_bounded_and_a_pause_makes_up_for_it() -> None:
    limit = RequestLimit(0.0)
    assert sum(limit.allows(0.001 * count) for count in range(1000)) in range(140, 155)  # a burst, and 50 in a second
    assert limit.refused > 0
    assert not limit.exhausted
    assert [limit.is_to_be_told(now) for now in (1.0, 1.5, 2.0)] == [True, False, True]
    assert limit.allows(10.0)
    assert limit.refused == 0
    assert sum(limit.allows(10.0) for _ in range(1200)) == 99
    assert limit.exhausted
    slower = RequestLimit(0.0)
    assert sum(slower.allows(count / 200) for count in range(2000)) in range(590, 602)  # some are allowed all the while
    assert slower.exhausted


def test_a_page_that_reads_slowly_misses_steps_and_gets_the_newest_of_each_report() -> None:
    page = PageClient('a', 'load of a', 'en')
    for count in range(10_000):
        page.show(count.to_bytes(2, 'little'))
        page.tell('knobs', str(count))
    frames = asyncio.run(page.next())
    assert frames[0] == '9999'
    assert [int.from_bytes(frame, 'little') for frame in frames[1:]] == list(range(9970, 10_000))
    page.tell('knobs', '9999')  # is known there
    page.tell('fit', '1')
    assert asyncio.run(page.next()) == ['1']


def test_one_page_works_the_bench_and_gets_it_back_after_a_lost_link() -> None:
    pages, first, second = PageClients(), PageClient('a', 'load of a', 'en'), PageClient('b', 'load of b', 'en')
    pages.join(first, 0.0)
    pages.join(second, 1.0)
    assert (pages.works(first), pages.works(second)) == (True, False)
    pages.leave(first, 2.0)
    pages.hand_on(3.0)
    assert not pages.works(second)
    again = PageClient('a', 'load of a', 'en')
    pages.join(again, 4.0)
    assert (pages.works(again), pages.works(second)) == (True, False)
    pages.leave(again, 5.0)
    pages.hand_on(9.0)
    assert pages.works(second)
    pages.leave(second, 10.0)
    third = PageClient('e', 'load of e', 'en')
    pages.join(third, 10.0)  # an empty bench
    assert pages.works(third)
    second = third
    doubled = PageClient('e', 'another load of e', 'en')
    pages.join(doubled, 9.0)
    assert (pages.works(second), pages.works(doubled)) == (True, False)
    returned = PageClient('e', 'load of e', 'en')
    pages.join(returned, 9.0)
    assert [pages.works(each) for each in (second, doubled, returned)] == [False, False, True]
    pages.leave(second, 9.0)  # that it was lost is noticed late
    assert [pages.works(each) for each in (doubled, returned)] == [False, True]
    for _ in range(MOST_PAGES - 2):
        pages.join(PageClient('c', 'load of c', 'en'), 9.0)
    with pytest.raises(PageRequestError, match='pages are open'):
        pages.join(PageClient('d', 'load of d', 'en'), 9.0)


@pytest.mark.parametrize(
    ('listens', 'host', 'origin', 'allowed'),
    [
        ('127.0.0.1', '127.0.0.1:80', None, True),
        ('127.0.0.1', 'localhost:80', 'http://localhost:80', True),
        ('127.0.0.1', 'localhost', 'http://localhost', True),
        ('127.0.0.1', '127.0.0.1:80', 'http://evil.example', False),
        ('127.0.0.1', '127.0.0.1:80', 'null', False),
        ('127.0.0.1', '127.0.0.1:81', None, False),
        ('127.0.0.1', 'evil.example:80', 'http://evil.example:80', False),
        ('127.0.0.1', '', None, False),
        ('127.0.0.1', '[::1', None, False),
        ('0.0.0.0', '192.0.2.7:80', 'http://192.0.2.7:80', True),  # noqa: S104
        ('0.0.0.0', 'evil.example:80', 'http://evil.example:80', False),  # noqa: S104
    ],
)
def test_only_the_page_of_the_bench_reaches_it(listens: str, host: str, origin: str | None, *, allowed: bool) -> None:
    access = Access.of(listens, 80)
    headers = {'host': host} | ({} if origin is None else {'origin': origin})
    assert (access.refusal(headers, {'token': access.token or ''}, public=False) is None) == allowed


def test_beyond_loopback_a_link_needs_its_token() -> None:
    access, headers = Access.of('192.0.2.7', 80), {'host': '192.0.2.7'}
    assert access.token
    assert access.url == f'http://192.0.2.7:80/?token={access.token}'
    for token in ('', 'wrong', 'schlüssel', access.token[:-1]):
        assert 'token' in str(access.refusal(headers, {'token': token}, public=False))
    assert access.refusal(headers, {'token': access.token}, public=False) is None
    assert access.refusal(headers, {}, public=True) is None
    assert access.token not in repr(access)
    assert Access.of('127.0.0.1', 80).token is None


@pytest.mark.parametrize(
    ('table', 'why'),
    [
        ('forcing_rpm,period_s\n2240,0.6\n2640,0.5\n', None),
        ('forcing_rpm,period_s\n2240,0.6\n2640,0.7\n', 'the swing does not quicken'),
        (None, 'the fit failed: AttributeError('),  # a defect: a table that is no path
    ],
)
def test_a_fit_is_told_as_worked_out_and_then_as_it_ended(tmp_path: Path, table: str | None, why: str | None) -> None:
    path = None if table is None else tmp_path / 'mine.csv'
    if path is not None:
        path.write_text(table)
    told = []

    async def fitted() -> None:
        ended = asyncio.Event()

        def change() -> None:
            told.append(fit.values({})['why'])
            if len(told) == 2:
                ended.set()

        fit = BookFit(Plant(), 1e-4, change)
        fit.begin(path, 2)
        await ended.wait()

    asyncio.run(fitted())
    assert told[0] == 'the fit is being worked out'
    assert told[1] is None if why is None else why in told[1]


def test_a_refusal_is_said_in_the_language_of_the_page() -> None:
    error = PageRequestError('a count from 1 to {most}', most=9)
    assert str(error) == 'a count from 1 to 9'
    assert error.said.said_by(words_of('de')) == 'eine Zahl von 1 bis 9'


def test_an_error_of_a_deeper_room_is_said_in_the_language_of_the_page() -> None:
    german = words_of('de')
    with pytest.raises(QuantityError) as typed:
        parse_speed('2500 rpn')
    german_text = "'2500 rpn' ist keine Zahl mit einer Einheit, die sich in rad/s umrechnen lässt"
    assert typed.value.said.said_by(german) == german_text
    with pytest.raises(KapitsaError) as asked:
        check_speed(900.0, 523.6)
    assert asked.value.said.said_by(german).startswith('eine Drehzahl von 8594.37 1/min (900 rad/s)')
    with pytest.raises(KapitsaError) as table:
        refuse_mixed_units(Readings(*np.array([[200.0], [9000.0], [0.0], [0.0]])))
    assert str(table.value) == 'row 1: a period of 9000 s: give the period in seconds, neither milliseconds nor RPM'
    assert table.value.said.said_by(german).startswith('Zeile 1: eine Periode von 9000 s')
    miscount = TimingRow(kind='timed', speed=200.0, swings=3, swings_taken=4, run=2).miscount
    assert miscount == 'run 2: 3 swings counted, taken as 4, by the other readings'
    assert said_by(miscount, german).startswith('Lauf 2: 3 Schwingungen gezählt')
    death = RigError('{node} died with status {status}{lines}', node='jigsaw', status=1, lines=': no disk')
    said = said_of(death)
    assert pickle.loads(pickle.dumps(said)).said_by(german) == 'jigsaw ist mit Status 1 gestorben: no disk'  # noqa: S301


def test_a_frame_has_the_motion_and_the_flashes_of_its_step() -> None:
    period, speed = 0.001, 2240 * RPM
    time = period * np.arange(101)
    pivot = SampledMotion(period, -0.0127 * np.cos(speed * time), np.sin(speed * time), np.zeros(101))
    lamp = Lamp(StrobeSettings(), 0.0127)
    lamp.turn(2 * speed)
    lamp.shine(0.0, pivot)
    times, marks = lamp.flashes(0.0, 0.1)
    assert times == pytest.approx(np.arange(8) / (2 * 2240 / 60))
    assert lamp.flashes(0.1, 0.2)[0].size == 0
    frame = encode_motion(3, 0.0, pivot, pivot, (times, marks))
    assert struct.unpack_from('<IIddI', frame) == (3, 101, 0.0, period, 8)
    floats = np.frombuffer(frame, '<f4', offset=28)
    assert floats[:101] == pytest.approx(pivot.position, abs=1e-8)
    assert floats[202:210] == pytest.approx(times)
    assert floats[210:] == pytest.approx(marks, abs=1e-6)


def test_languages_are_chosen_by_link_then_by_browser() -> None:
    assert languages() == ('en', 'de')
    assert choose_language(None, 'fr-CH, de-DE;q=0.9, en;q=0.8') == 'de'
    assert choose_language('en', 'de') == 'en'
    assert choose_language('../../etc', 'xx') == 'en'


DEEPER = (
    '_api/reduce.py', 'address_space.py', 'analysis/errors.py', 'analysis/line_fit.py', 'analysis/table.py',
    'analysis/timing_row.py', 'bench/bench_state.py', 'bench/notebook.py', 'bench/rig_worker.py',
    'bench/stopwatch.py', 'operator/requests.py', 'rig/harness.py', 'rig/node_group.py', 'rig/simulation_control.py',
    'rig/waiting.py', 'units.py',
)  # fmt: skip
"""Rooms without a page whose sentences reach one."""


def sentences() -> set[str]:
    """Every sentence that a page can show and a catalogue should have, found where it stands."""
    found: set[str] = set()
    for page in STATIC.glob('*.html'):
        found |= set(re.findall(r'\[\[(.+?)\]\]', page.read_text(encoding='utf-8')))
    for script in STATIC.glob('*.js'):
        text = script.read_text(encoding='utf-8')
        for call in re.findall(r"\bsay\(((?:'[^']*'|[^;'])*?)\)", text):
            found |= set(re.findall(r"'([^']+)'", call))
    for folder in ('bench', 'web'):
        for module in set((PACKAGE / folder).glob('*.py')) - {PACKAGE / 'bench' / 'app.py'}:  # the terminal's own
            text = module.read_text(encoding='utf-8')
            found |= set(re.findall(r"(?:(?:notify|Message|PageRequestError)\(\s*|: (?='run ))'([^']+)'", text))
    return found


def errors_of_deeper_rooms() -> set[str]:
    """What is wrong with a request, a reading or a rig, as the rooms that find it say it: by the calls that make it."""
    found: set[str] = set()
    for name in DEEPER:
        tree = ast.parse((PACKAGE / name).read_text(encoding='utf-8'))
        for call in ast.walk(tree):
            if isinstance(call, ast.Call) and re.search(r'(Error|Message|__init__|_refuse)$', ast.unparse(call.func)):
                constants = [argument.value for argument in call.args if isinstance(argument, ast.Constant)]
                found |= {value for value in constants if isinstance(value, str)}
    return found


@pytest.mark.parametrize('language', ['de'])
def test_a_catalogue_has_every_sentence_with_its_values(language: str) -> None:
    words = words_of(language)
    assert sentences() | errors_of_deeper_rooms() == words.keys()
    for english, other in words.items():
        names = [{field for _, field, _, _ in string.Formatter().parse(text) if field} for text in (english, other)]
        assert names[0] == names[1], english


def test_a_message_is_said_in_another_language_and_names_stay_what_they_are() -> None:
    assert Message('released from {angle:.4g} rad', angle=0.12).said_by(words_of('de')) == 'losgelassen bei 0.12 rad'
    assert Message('{why} is wrong').said_by(words_of('de')) == '{why} is wrong'
    assert translated('<p>[[Pause]]</p>', 'de') == '<p>Anhalten</p>'
    assert translated('<p>[[a & b]]</p>', 'en') == '<p>a &amp; b</p>'


def test_nothing_is_loaded_from_elsewhere_and_no_text_is_taken_for_markup() -> None:
    files = [path for path in STATIC.iterdir() if path.suffix in {'.html', '.js', '.css'}]
    assert len(files) >= 10
    for path in files:
        text = path.read_text(encoding='utf-8')
        assert '//' not in re.sub(r'^\s*//.*$|\s// .*$|\$\{[^}]*\}://', '', text, flags=re.MULTILINE), path.name
        assert not re.search(r'innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(|new Function', text)
    json.loads((PACKAGE / 'web' / 'words' / 'de.json').read_text(encoding='utf-8'))
