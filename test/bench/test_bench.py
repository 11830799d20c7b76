"""The bench: what lies on it, what is drawn of it, and a person who works it in a terminal."""

import asyncio
import fcntl
import math
import os
import pty
import re
import select
import shlex
import signal
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.bench.bench_clock import BenchClock
from kapitsa_ros.bench.bench_files import print_what_is_left
from kapitsa_ros.bench.bench_state import BenchState
from kapitsa_ros.bench.drawing import draw_dial, draw_marks, draw_rod, draw_ruler
from kapitsa_ros.bench.notebook import Notebook, Row
from kapitsa_ros.bench.stopwatch import HandStopwatch
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.tables import load_timings, read_table, read_timings
from kapitsa_ros.instruments.errors import InstrumentError
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.laboratory.bag_analysis import analyse_bags
from kapitsa_ros.network.registry import ROLE_NAMES
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.operator.errors import RequestError
from kapitsa_ros.physics.jigsaw import Jigsaw
from kapitsa_ros.physics.jigsaw_parameters import JigsawParameters
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.physics.theory.averaged import omega_crit_averaged
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig import Rig, RigError
from kapitsa_ros.rig.environment import node_environment
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.rig.session import replay_bags
from kapitsa_ros.rig.setup import Replay
from kapitsa_ros.ros.rig_client import News
from kapitsa_ros.units import RPM

pytest.importorskip('textual')
from textual import events
from textual.pilot import Pilot
from textual.widgets import Input

from kapitsa_ros.bench.app import HEIGHT, BenchApp
from kapitsa_ros.bench.help_text import help_text

pytestmark = pytest.mark.xdist_group('bench')
PATIENCE = 180.0
_NAMES = {'.': 'full_stop', '?': 'question_mark'}
OF_1997 = load_instruments('1997')


# What lies on the bench.


def test_the_clock_runs_on_between_blocks_and_never_beyond_what_is_known():
    clock = BenchClock(rate=2.0)
    assert clock.now(0.0) == 0.0
    clock.follow(100.0, 0.0, 0.1)
    assert clock.now(100.0) == pytest.approx(0.0)
    assert clock.now(100.02) == pytest.approx(0.04)
    assert clock.now(100.5) == 0.1
    clock.follow(100.05, 0.1, 0.2)
    assert clock.now(100.06) == pytest.approx(0.12)


def test_the_clock_follows_the_blocks_that_come_in_time():
    clock = BenchClock(rate=1.0)
    clock.follow(10.03, 0.0, 0.1)  # late
    clock.follow(10.10, 0.1, 0.2)
    clock.follow(10.25, 0.2, 0.3)  # late
    assert clock.now(10.25) == pytest.approx(0.25)
    clock.follow(15.0, 0.3, 0.4)  # time stood still meanwhile
    assert clock.now(15.05) == pytest.approx(0.35)


def test_the_clock_never_goes_back_within_a_run():
    clock = BenchClock(rate=1.0)
    clock.follow(10.0, 0.0, 0.1)
    clock.follow(10.1, 0.1, 0.2)
    assert clock.now(10.3) == 0.2
    clock.follow(11.0, 0.1, 0.3)  # heard late
    assert clock.now(11.05) == 0.2
    assert clock.now(11.15) == pytest.approx(0.25)
    clock.restart()
    assert clock.now(11.0) == 0.0


def test_the_clock_of_a_paused_rig_stands_at_the_end_of_what_is_known(state: BenchState):
    """A watch that is pressed then would else be started within a block that is over."""
    state.clock.follow(10.0, 0.0, 0.1)
    assert state.clock.now(10.03) == pytest.approx(0.03)
    state.set_paused(paused=True)
    assert state.clock.now(10.031) == state.clock.now(10.04) == 0.1
    state.clock.follow(12.0, 0.1, 0.2)  # a single step
    assert state.clock.now(12.001) == 0.2
    state.set_paused(paused=False)
    state.clock.follow(20.0, 0.2, 0.3)
    assert state.clock.now(20.05) == pytest.approx(0.25)


def test_the_clock_measures_the_rate():
    clock = BenchClock(rate=0.0)
    assert math.isnan(clock.measured_rate(0.0))
    for count in range(50):
        clock.follow(0.1 * count, 0.5 * count, 0.5 * (count + 1))
        assert clock.now(0.1 * count) == 0.5 * (count + 1)
    assert clock.measured_rate(4.9) == pytest.approx(5.0)


def test_the_stopwatch_shows_completed_hundredths():
    watch = HandStopwatch(OF_1997.stopwatch)
    assert (watch.runs, watch.shown(5.0)) == (False, 0.0)
    watch.press(5.0)
    assert watch.runs
    assert watch.shown(6.2399) == pytest.approx(1.23)
    watch.press(7.1299)
    assert not watch.runs
    assert watch.shown(99.0) == pytest.approx(2.12)
    watch.press(100.0)
    assert watch.shown(100.5) == pytest.approx(0.5)
    watch.clear()
    assert watch.shown(101.0) == 0.0


def test_a_watch_that_runs_fast():
    watch = HandStopwatch(StopwatchSettings(rate_error=0.1))
    watch.press(0.0)
    watch.press(2.0)
    assert watch.shown(3.0) == pytest.approx(2.2)


def row(rpm: float, period: float) -> Row:
    return Row(run=1, forcing_rpm=rpm, period_s=period, display_s=3 * period, swings=3, release_rad=-0.1)


def test_the_notebook_is_on_disk_with_every_line(tmp_path: Path):
    path = tmp_path / 'mine.csv'
    book = Notebook(path)
    assert book.strike_out() is None
    for rpm, period in ((2240.0, 0.61), (2640.0, 0.4733333333), (2780.0, 0.44)):
        book.write_down(row(rpm, period))
    assert read_table(path).forcing / RPM == pytest.approx([2240, 2640, 2780])
    assert read_table(path).period == pytest.approx([0.61, 0.4733333333, 0.44], rel=1e-9)
    written = read_timings(path).rows
    assert [(each.run, each.swings, each.release) for each in written] == [(1, 3, -0.1)] * 3
    assert [each.displayed for each in written] == pytest.approx([1.83, 1.42, 1.32], rel=1e-9)
    assert book.strike_out() == row(2780.0, 0.44)
    assert read_table(path).forcing.size == 2
    for wrong in (row(0.0, 1.0), row(2240.0, 0.0)):
        with pytest.raises(TableError, match='lamp'):
            book.write_down(wrong)
    with pytest.raises(TableError, match='should take many turns'):
        book.write_down(row(40.0, 0.5))
    assert len(book.rows) == read_table(path).forcing.size == 2
    book.note('the plot of θ(t)\nwas looked at')
    assert book.strike_out(1) == row(2240.0, 0.61)
    for gone in (0, 1, 3, 4):
        with pytest.raises(TableError, match='not there, or is struck out'):
            book.strike_out(gone)
    assert [line.split(',')[0] for line in path.read_text().splitlines()] == [
        'forcing_rpm', '# struck out: 2240', '2640', '# struck out: 2780', '# the plot of θ(t) was looked at',
    ]  # fmt: skip
    assert read_table(path).forcing / RPM == pytest.approx([2640])
    assert path.read_text() == book.text()


def test_the_command_that_reduces_the_book_names_the_plant(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], kapitsa: Callable[..., Any]
):
    plant = Plant(amplitude=0.01016, length=0.2)
    notebook = Notebook(tmp_path / 'mine.csv')
    for rpm, period in ((2240, 0.7), (2640, 0.55)):
        notebook.write_down(
            Row(run=1, forcing_rpm=rpm, period_s=period, display_s=3 * period, swings=3, release_rad=0.12)
        )
    print_what_is_left([tmp_path], notebook, plant)
    command = shlex.split(capsys.readouterr().out.partition('mine.csv: ')[2])
    assert command[:3] == ['kapitsa', 'reduce', str(tmp_path / 'mine.csv')]
    found = kapitsa(*command[1:], '--json').json
    assert found['predicted_rpm'] == pytest.approx(1519.93, abs=0.01)  # (2/λ)√(gL/3)


def test_a_notebook_overwrites_nothing(tmp_path: Path):
    path = tmp_path / 'mine.csv'
    path.write_text('precious')
    with pytest.raises(UsageError, match='never overwritten'):
        Notebook(path)
    with pytest.raises(UsageError, match='cannot be written'):
        Notebook(tmp_path / 'nowhere' / 'mine.csv')
    assert path.read_text() == 'precious'


@pytest.fixture
def state(tmp_path: Path) -> BenchState:
    return BenchState(Plant(), OF_1997, Notebook(tmp_path / 'mine.csv'), 1.0)


class Graph:
    """Says what a graph would: a shaft at a speed, a rod at an angle."""

    def __init__(self, state: BenchState, rpm: float, run: int = 1) -> None:
        self._state = state
        run_up = 0.01  # s
        parameters = JigsawParameters(phase=0.7 - rpm * RPM * run_up / 2, spin_up=1e5)
        self._shaft = Jigsaw(amplitude=Plant().amplitude, parameters=parameters)
        self._shaft.advance(rpm * RPM, run_up, 1)
        self._rpm = rpm
        self._step_id = StepId(run, 0)

    def notify(self, steps: int, angle: float = 0.1) -> None:
        for _ in range(steps):
            still = np.zeros(101)
            self._state.receive(
                [
                    News('jigsaw/pivot', self._step_id, self._shaft.advance(self._rpm * RPM, 0.1, 100)),
                    News('pendulum/motion', self._step_id, SampledMotion(0.001, still + angle, still, still)),
                ],
                0.1 * self._step_id.step,
            )
            self._step_id = StepId(self._step_id.run, self._step_id.step + 1)


def test_a_person_reads_the_dial_to_its_graduations(state: BenchState):
    Graph(state, 2240).notify(5)
    state.turn_dial(4480)
    graph = Graph(state, 2240, run=2)
    graph.notify(5)
    heights, shares = state.picture(0.5)
    assert heights.size == 2
    assert (shares >= state.faintest).all()
    assert state.forcing == 2240
    for _ in range(2):
        state.turn_dial(state.dial + state.lamp_dial.touch)
    assert (state.dial, state.dial_reading) == (pytest.approx(4488), pytest.approx(4480))
    state.turn_dial(state.dial + state.lamp_dial.touch)
    assert state.forcing == 2250
    state.images = 3
    assert state.forcing == 1500
    state.turn_dial(-3)
    assert state.dial == 0
    state.turn_dial(1e9)
    assert state.dial == pytest.approx(25_000, rel=1e-4)
    with pytest.raises(InstrumentError, match='give a number'):
        state.turn_dial(math.nan)


def test_what_cannot_be_asked_for_leaves_the_knobs(state: BenchState):
    state.set_speed(2000)
    for wrong in (-1.0, 5001.0, math.nan):
        with pytest.raises(RequestError, match='5000 RPM'):
            state.set_speed(wrong)
    with pytest.raises(RequestError, match='quarter turn'):
        state.set_release(2.0)
    assert (state.speed, state.release) == (2000, 0.12)


def test_a_reading_is_written_down_when_it_is_whole(state: BenchState):
    Graph(state, 2240).notify(1)
    state.write_down(0.0)
    assert state.messages[-1].startswith('not written down: set the dial')
    state.turn_dial(4480)
    state.press_watch(1.0)
    state.write_down(2.0)
    assert state.messages[-1].startswith('not written down: stop the watch')
    state.press_watch(2.83)
    state.note_release(-0.2)
    state.set_release(0.3)  # the next one's
    state.write_down(9.0)
    [written] = state.notebook.rows
    assert (written.run, written.forcing_rpm, written.swings, written.release_rad) == (1, 2240.0, 3, -0.2)
    assert (written.display_s, written.period_s) == pytest.approx((1.83, 0.61))
    assert state.watch.shown(9.0) == 0.0
    state.write_down(9.0)
    assert len(state.notebook.rows) == 1
    state.strike_out()
    assert not state.notebook.rows


def test_the_state_reports_what_happens(state: BenchState):
    graph = Graph(state, 2240)
    graph.notify(3, angle=0.25)
    assert state.angle(0.15) == pytest.approx(0.25)
    state.check_fall(0.2)
    graph.notify(3, angle=math.pi / 2)
    for _ in range(2):
        state.check_fall(0.5)
    assert [line for line in state.messages if 'fell' in line] == [state.messages[-1]]
    reading = StrobeReading(time=1.0, speed=2240 * RPM)
    state.receive([News('strobe/reading', StepId(1, 5), reading)], 1.0)
    assert list(state.rig_readings) == [(1, reading)]
    result = {'run 1': {'speed_reading_rpm': 2240.0, 'period_s': 0.61, 'slow_rpm': 98.4, 'fell': True}}
    state.receive([News('analyser/result', StepId(1, 6, end=True), result)], 1.0)
    assert state.messages[-1] == 'run 1 is over; the rig read 2240 RPM, a period of 0.610 s'
    Graph(state, 0, run=2).notify(1)
    assert state.run == 2
    graph.notify(1, angle=1.0)  # a straggler of the earlier run
    assert state.angle(0.05) == pytest.approx(0.1)


# What is drawn.


def columns(lines: list[str]) -> list[float]:
    """Return the mean column of what is drawn in each line that is not empty."""
    found = [[i for i, sign in enumerate(line) if sign != ' '] for line in lines]
    return [sum(places) / len(places) for places in found if places]


@pytest.mark.parametrize('angle', [-0.6, -0.12, 0.0, 0.12, 0.6])
def test_the_rod_leans_as_it_should(angle: float):
    lines = draw_rod(angle, 41, 12)
    assert [len(line) for line in lines] == [41] * 12
    middles = columns(lines[:-1])
    assert middles[-1] == pytest.approx(20, abs=1)
    # A character is two dots wide and four high.
    slope = (middles[0] - middles[-1]) * 2 / ((len(middles) - 1) * 4)
    assert slope == pytest.approx(math.tan(angle), abs=0.06)


@pytest.mark.parametrize('angle', [-math.pi / 2, math.pi / 2])
def test_a_rod_that_lies_stays_within_the_drawing(angle: float):
    lines = draw_rod(angle, 41, 12)
    assert all(not line.strip() for line in lines[:10])
    assert math.copysign(1, columns(lines[-1:])[0] - 20) == math.copysign(1, angle)


def test_the_ruler_shows_the_tip_finer():
    assert draw_ruler(0.0, 0.2, 41).index('◆') == 20
    assert draw_ruler(0.1, 0.2, 41).index('◆') == 30
    assert draw_ruler(-9.0, 0.2, 41).index('◆') == 0
    assert draw_ruler(0.1, 0.2, 41)[20] == '┼'


def test_marks_are_drawn_at_their_heights():
    lines = draw_marks(np.array([-1.0, 0.0, 1.0]), np.array([0.4, 0.1, 0.5]), 0.2, 4, 11)
    drawn = {row: line for row, line in enumerate(lines) if line[0].strip()}
    assert drawn == {0: ('▔▔▔▔', True), 5: ('┈┈┈┈', False), 10: ('▁▁▁▁', True)}
    # A bright image covers a glimmer on the same line.
    both = draw_marks(np.array([0.0, 0.01]), np.array([0.1, 0.9]), 0.2, 4, 11)
    assert [line for line in both if line[0].strip()] == [('━━━━', True)]
    assert not any(bright for _, bright in draw_marks(np.empty(0), np.empty(0), 0.2, 4, 11))


def test_an_image_that_rises_is_drawn_ever_higher():
    def place(height: float) -> int:
        lines = draw_marks(np.array([height]), np.array([1.0]), 0.2, 1, 11)
        row = next(row for row, line in enumerate(lines) if line[1])
        return 3 * row + '▔━▁'.index(lines[row][0])

    places = [place(height) for height in np.linspace(-1, 1, 33)]
    assert places == list(range(32, -1, -1))


def test_the_needle_stands_and_the_scale_moves():
    needle, scale = draw_dial(4480, 20, 33)
    assert needle.index('▼') == scale.index('|', 9) == 16
    assert draw_dial(4485, 20, 33)[1].index('|', 9) == 14
    assert draw_dial(4475, 20, 33)[1].index('|', 12) == 18


# A person at the screen.


class Person:
    """Presses keys in an app that runs without a terminal, as fast as they come, and waits until things are so."""

    def __init__(self, app: BenchApp) -> None:
        self.app = app

    def press(self, *keys: str) -> None:
        for key in keys:
            self.app.post_message(events.Key(_NAMES.get(key, key), key if len(key) == 1 else None))

    async def type(self, key: str, text: str) -> None:
        self.press(key, *text)
        await self.until(lambda: self.app.query_one('#answer', Input).value == text)
        self.press('enter')
        await self.until(lambda: self.app._question is None)

    async def until(self, true: Callable[[], Any]) -> None:
        deadline = time.monotonic() + PATIENCE
        while not true():
            assert time.monotonic() < deadline, list(self.app.state.messages)
            await asyncio.sleep(0.02)

    async def told(self, text: str) -> None:
        await self.until(lambda: any(text in line for line in self.app.state.messages))

    def text(self, name: str) -> str:
        widget = self.app.screen_stack[0].query_one(f'#{name}')
        lines = [widget.render_line(row).text for row in range(widget.size.height)]
        return '\n'.join(line.rstrip() for line in lines)


def in_front_of(
    rig: Rig, state: BenchState, work: Callable[[Person, Pilot[Any]], Any], size: tuple[int, int] = (100, 32)
) -> Any:
    """Let somebody work at a bench; return what the screen returns."""
    app = BenchApp(rig, state, 'bench')

    async def sit() -> None:
        async with app.run_test(size=size) as pilot:
            await work(Person(app), pilot)

    asyncio.run(sit())
    return app.return_value


def test_a_laboratory_by_hand(tmp_path: Path, kapitsa: Callable[..., Any]):
    """Two speeds, read by the person, reduced from their table; replaying the bags gives what the rig said."""
    state = BenchState(Plant(), load_instruments('ideal'), Notebook(tmp_path / 'mine.csv'), 10.0)

    def read_in(run: int) -> int:
        return sum(of == run for of, _ in state.rig_readings)

    def images_drawn(person: Person) -> int:
        return sum(bool(re.search('[▔━▁]', line)) for line in person.text('marks').splitlines())

    async def time_a_swing(person: Person, tenths: int) -> None:
        """Press the watch of a rig that stands still, so that it is pressed at a tenth of a second."""
        person.press('p')
        await person.until(lambda: 'PAUSED' in person.text('status'))
        heights, _ = state.picture(person.app.controls.now())
        # Half a turn apart, the two images lie on each other where the mark is at mid-stroke as the lamp flashes.
        drawn = {2} if np.ptp(heights) > 0.3 else {1, 2}
        await person.until(lambda: images_drawn(person) in drawn)
        person.press('space')
        await person.until(lambda: state.watch.runs)
        begun = person.app.controls.now()
        person.press(*'n' * tenths)
        await person.until(lambda: person.app.controls.now() > begun + 0.1 * tenths - 0.01)
        person.press('space', 'w')
        await person.told('written down')
        person.press('p')
        await person.until(lambda: not state.paused)

    async def work(person: Person, _: Pilot[Any]) -> None:
        for run, (rpm, tenths) in enumerate(((2240, 18), (2640, 14)), start=1):
            await person.until(lambda run=run: state.run == run)
            await person.type('s', str(rpm))
            await person.type('d', str(2 * rpm))
            await person.until(lambda run=run: read_in(run) == 1)
            assert f'speed asked    {rpm} RPM' in person.text('knobs')
            person.press('r')
            await person.until(lambda run=run: read_in(run) == 2)
            await time_a_swing(person, tenths)
            assert state.notebook.rows[-1].forcing_rpm == rpm
            assert state.notebook.rows[-1].period_s == pytest.approx(tenths / 30)
            person.press('x')
            await person.told(f'run {run} is over')
        person.press('q')
        await person.until(lambda: person.app._exit)

    with Rig('ideal', 'ideal', rate=10, bags=tmp_path / 'bags') as rig:
        assert in_front_of(rig, state, work) is None
    bags = sorted((tmp_path / 'bags').iterdir())
    assert all(RunBag(bag).complete for bag in bags)
    read, replayed = analyse_bags(bags[:2]), replay_bags(bags[:2], Replay(), lambda _: None)
    del replayed['realtime_factor']
    assert replayed == read
    for run in read['runs']:
        said = f'the rig read {run["speed_reading_rpm"]:.6g} RPM, a period of {run["period_s"]:.3f} s'
        assert any(said in line for line in state.messages)
    answer = kapitsa('reduce', tmp_path / 'mine.csv', '--json').json
    assert answer['inverse_rpm'] is not None
    for written, noted in zip(load_timings(tmp_path / 'mine.csv').rows, state.notebook.rows, strict=True):
        assert (written.speed, written.period) == pytest.approx((noted.forcing_rpm * RPM, noted.period_s), rel=1e-9)
    kapitsa('report', *bags[:2], '--output', tmp_path / 'report.md')
    tells_what_was_read((tmp_path / 'report.md').read_text(encoding='utf-8'), read)


def tells_what_was_read(report: str, values: dict[str, Any]) -> None:
    """Assert that a report has the digits of an analysis of the same bags."""
    assert f'{values["omega_crit_rpm"]:.0f} RPM' in report
    for timing in values['timings']:
        period = timing['display_s'] / timing['swings']
        asked, shown = timing['speed_asked_rpm'], timing['speed_reading_rpm']
        assert re.search(rf'\| ?{asked:.0f} ?\| ?{shown:.1f} ± \S+ ?\| ?{period:.3f} ± ', report), [
            line for line in report.splitlines() if '±' in line
        ]


def test_the_screen_says_what_is_wrong(tmp_path: Path):
    state = BenchState(Plant(), OF_1997, Notebook(tmp_path / 'mine.csv'), 1.0)

    async def work(person: Person, pilot: Pilot[Any]) -> None:
        person.press('up')
        await person.told('the nodes are starting')
        assert state.speed == 0
        start_recorder()
        await person.until(lambda: state.run)
        for key, typed, words in (
            ('s', '9000', '5000 RPM'),
            ('a', '3.0', 'quarter turn'),
            ('d', 'soon', "'soon' is not"),
        ):
            await person.type(key, typed)
            await person.told(words)
        assert (state.speed, state.release, state.dial) == (0.0, 0.12, 0.0)
        await person.type('a', '7deg')
        assert state.release == pytest.approx(math.radians(7))
        person.press('s', '2', 'escape')
        await person.until(lambda: person.app._question is None and person.app.focused is None)
        person.press('up', 'pageup', 'down', 'pagedown', 'up')
        await person.until(lambda: state.speed == 10)
        person.press('?')
        await person.until(lambda: len(person.app.screen_stack) == 2)
        assert len(help_text(Plant()).splitlines()) + 2 <= HEIGHT  # with its border
        assert 'Below 1353 RPM' in help_text(Plant())
        smaller = Plant(amplitude=0.01016)
        assert f'Below {omega_crit_averaged(smaller) / RPM:.0f} RPM' in help_text(smaller)
        person.press('s')  # goes back, and asks nothing
        await person.until(lambda: len(person.app.screen_stack) == 1)
        assert person.app._question is None
        person.press('n')  # of a rig that is not paused
        await person.told('time runs')
        await pilot.resize_terminal(60, 20)
        await person.until(lambda: 'needs 80 columns' in person.text('small'))
        rig.processes['stopwatch'].end(signal.SIGKILL)
        await person.until(lambda: person.app._exit)

    folder = tmp_path / 'bags'
    recorder = [sys.executable, '-m', 'kapitsa_ros', 'node', 'recorder', '--ros-args', '-p', f'bags:={folder}']
    last: list[subprocess.Popen[bytes]] = []

    def start_recorder() -> None:
        """Start the node that all wait for, once somebody has seen that nodes are starting."""
        last.append(subprocess.Popen(recorder, env=node_environment(rig.domain)))

    try:
        with Rig(rate=1, nodes=[role for role in ROLE_NAMES if role != 'recorder'], bags=folder) as rig:
            error = in_front_of(rig, state, work)
    finally:
        for process in last:
            process.kill()
            process.wait()
    assert isinstance(error, RigError)
    assert 'stopwatch was killed by SIGKILL' in str(error)


# The command in a terminal of its own.


class Terminal:
    """A command of Python's in a pseudo-terminal."""

    def __init__(self, folder: Path, *command: str) -> None:
        self._master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack('HHHH', 32, 100, 0, 0))
        self.process = subprocess.Popen(
            ['/usr/bin/setsid', '--ctty', sys.executable, *command],
            stdin=slave,
            stdout=slave,
            stderr=slave,
            cwd=folder,
            env=os.environ | {'TERM': 'xterm-256color', 'PYTHONPATH': str(Path(__file__).parents[2])},
        )
        os.close(slave)
        self.shown = ''

    def read_until(self, true: Callable[[], Any]) -> None:
        """Read what is drawn until something is so."""
        deadline = time.monotonic() + PATIENCE
        while not true():
            assert time.monotonic() < deadline, self.shown[-2000:]
            assert self._read(), self.shown[-2000:]

    def end(self) -> int:
        """Read to the end, and return the exit status."""
        while self._read():
            pass
        return self.process.wait(PATIENCE)

    def hang_up(self) -> None:
        os.close(self._master)
        self._master = -1

    def close(self) -> None:
        if self._master >= 0:
            os.close(self._master)
        self.process.kill()
        self.process.wait()

    def _read(self) -> bool:
        assert select.select([self._master], [], [], PATIENCE)[0]
        try:
            piece = os.read(self._master, 65536)
        except OSError:  # the other end is closed
            return False
        self.shown += piece.decode(errors='replace')
        return bool(piece)


@pytest.fixture
def terminal(tmp_path: Path) -> Iterator[Terminal]:
    """Hold `kapitsa bench` in a terminal."""
    terminal = Terminal(tmp_path, '-m', 'kapitsa_ros', 'bench', '--length', '10in')
    yield terminal
    terminal.close()


@pytest.mark.parametrize('end', ['asked', 'hung up', 'broken'])
def test_however_it_ends_nothing_is_left(
    terminal: Terminal, processes_of: Callable[[int], dict[str, int]], tmp_path: Path, end: str
):
    terminal.read_until(lambda: 'the shaft is at rest' in terminal.shown)
    nodes = processes_of(terminal.process.pid)
    assert nodes.keys() == {*ROLE_NAMES, 'fork_server'}
    terminal.read_until(lambda: list(tmp_path.glob('bench_01/run_*')))
    if end == 'asked':
        terminal.process.send_signal(signal.SIGTERM)
        assert terminal.end() == 0
        assert '1 run in bench_01: kapitsa analyse bench_01/*' in terminal.shown
        assert '\x1b[?1049l' in terminal.shown  # the screen is given back
        (bag,) = tmp_path.glob('bench_01/run_*')
        assert RunBag(bag).run.plant.length == 0.254
    elif end == 'hung up':
        terminal.hang_up()
        assert terminal.process.wait(PATIENCE) == 0
    else:
        os.kill(nodes['pendulum'], signal.SIGKILL)
        assert terminal.end() == 1
        last = terminal.shown.rpartition('\x1b[?1004l')[2].strip().splitlines()
        assert last == ['kapitsa: error: pendulum was killed by SIGKILL']
    assert 'Traceback' not in terminal.shown
    assert not [role for role, pid in nodes.items() if Path(f'/proc/{pid}').exists()]


def test_without_a_terminal_it_says_so(kapitsa: Callable[..., Any], tmp_path: Path):
    answer = kapitsa('bench', '--bags', tmp_path / 'bags')
    assert answer.status == 2
    assert answer.err.startswith('kapitsa: error: the bench needs a terminal')
    assert answer.err.count('\n') == 1
    assert not list(tmp_path.iterdir())


def test_what_is_there_is_not_overwritten(kapitsa: Callable[..., Any], tmp_path: Path):
    old = tmp_path / 'bags' / 'run_02_0rpm'
    old.mkdir(parents=True)
    answer = kapitsa('bench', '--bags', old.parent)
    assert (answer.status, 'never overwritten' in answer.err) == (2, True)
    table = tmp_path / 'mine.csv'
    table.write_text('precious')
    answer = kapitsa('bench', '--bags', tmp_path / 'others', '--table', table)
    assert (answer.status, 'never overwritten' in answer.err) == (2, True)
    assert table.read_text() == 'precious'


@pytest.mark.parametrize(('module', 'options', 'extra'), [('textual', [], 'bench'), ('uvicorn', ['--web'], 'web')])
def test_a_missing_extra_is_named(
    kapitsa: Callable[..., Any], tmp_path: Path, module: str, options: list[str], extra: str
):
    (tmp_path / f'{module}.py').write_text(f"raise ModuleNotFoundError('none here', name='{module}')")
    answer = kapitsa('bench', *options, env={'PYTHONPATH': f'{tmp_path}:{os.environ.get("PYTHONPATH", "")}'})
    assert answer.status == 1
    assert f'needs {module}: run `make setup`, or pip install "kapitsa_ros[{extra}]"' in answer.err


def test_nothing_but_the_screen_is_drawn_while_it_lasts(tmp_path: Path):
    """What C, Python and threads say on stderr comes when the terminal is free again, and is not lost."""
    work = """
import os, sys
from kapitsa_ros.bench.terminal import own_terminal
with own_terminal():
    os.write(2, b'from C\\n')
    print('from Python', file=sys.stderr)
    print('the screen', file=sys.__stderr__, flush=True)
print('afterwards', file=sys.stderr)
"""
    terminal = Terminal(tmp_path, '-c', work)
    try:
        assert terminal.end() == 0
        assert terminal.shown.split('\r\n') == ['the screen', 'from C', 'from Python', 'afterwards', '']
    finally:
        terminal.close()
