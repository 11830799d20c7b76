"""The rig in the hands of a Python program, and of a person who turns the knobs."""

import contextlib
import math
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64

from kapitsa_ros.analysis.slow_frequency import DEFAULT_ESTIMATOR, ESTIMATORS
from kapitsa_ros.laboratory.bag_analysis import analyse_bags
from kapitsa_ros.network import registry
from kapitsa_ros.operator.errors import RequestError
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig import Rig, RigError
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.rig.session import replay_bags
from kapitsa_ros.rig.setup import Replay
from kapitsa_ros.units import RPM

PATIENCE = 180.0
pytestmark = pytest.mark.xdist_group('harness')


@pytest.fixture(scope='module')
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Rig]:
    with Rig(instruments='ideal', bags=tmp_path_factory.mktemp('harness') / 'bags') as rig:
        yield rig


@pytest.fixture
def lab(shared: Rig) -> Iterator[Rig]:
    """The shared rig at the beginning of a run: reset makes it as good as new."""
    shared.reset()
    shared.set_rate(0)
    yield shared
    shared.set_rate(1)  # other tests need the machine, too


@pytest.fixture
def paused(lab: Rig) -> Iterator[Rig]:
    lab.pause()
    yield lab
    lab.resume()


def newest_bag(rig: Rig) -> Path:
    return max(rig.bags.iterdir(), key=lambda path: int(path.name.split('_')[1]))


def drain(rig: Rig, topic: str) -> int:
    """Read what is there; return how many there were."""
    count = 0
    with contextlib.suppress(TimeoutError):
        while rig.wait_for(topic, timeout=0) is not None:
            count += 1
    return count


def timed(rig: Rig, rpm: float, angle: float) -> float:
    """Return the period read after a release."""
    rig.request_speed(rpm)
    reading = rig.wait_for('strobe/reading', lambda reading: abs(reading.speed / RPM - rpm) < 1, timeout=PATIENCE)
    assert reading.speed == pytest.approx(rpm * RPM, rel=1e-8)
    rig.release(angle)
    reading = rig.wait_for('stopwatch/reading', timeout=PATIENCE)
    assert reading.kind == 'timed'
    return reading.displayed / reading.swings


def test_a_person_reads_the_nonlinear_truth(lab: Rig) -> None:
    for rpm, angle in ((2500, 0.12), (2000, -0.2)):
        truth = 2 * math.pi / slow_frequency_nonlinear(Plant(), rpm * RPM, abs(angle))
        assert timed(lab, rpm, angle) == pytest.approx(truth, rel=2e-3)


def test_a_manual_run_is_replayed_to_the_same_digits(lab: Rig) -> None:
    lab.set_rate(20)  # the replay takes as long as the run was: it need not be longer than the test is slow
    periods = [timed(lab, 2400, 0.1)]
    lab.pause()
    lab.resume()
    periods.append(timed(lab, 2600, 0.1))
    path = newest_bag(lab)
    lab.reset()
    number = RunBag(path).run.number
    live = lab.wait_for('analyser/result', lambda result: f'run {number}' in result, timeout=PATIENCE)[f'run {number}']
    assert live['period_s'] == pytest.approx(periods[-1])  # of the speed that was set last
    lab.set_rate(0.1)  # the next run would take the machine from the replay
    bag = RunBag(path)
    assert bag.complete
    assert bag.motion.gaps == 0
    read, replayed = analyse_bags([path]), replay_bags([path], Replay(), lambda _: None)
    del replayed['realtime_factor']
    assert replayed == read
    assert live.items() <= read['runs'][0].items()
    each = [(row['speed_taken_rpm'], row['display_s'] / row['swings']) for row in read['timings']]
    assert [speed for speed, _ in each] == pytest.approx([2400, 2600], abs=1)
    assert [period for _, period in each] == pytest.approx(periods)
    assert read['omega_crit_rpm'] == pytest.approx(1354.8, abs=0.5)
    recorded = bag.recorded
    swings = [swing for swing in recorded.swings() if recorded.timing_of(swing) is not None]
    assert [recorded.forcing_of(swing) / RPM for swing in swings] == pytest.approx([2400, 2600])
    slow = [ESTIMATORS[DEFAULT_ESTIMATOR](recorded.living_swing(swing), 0.0).value for swing in swings]
    assert slow == pytest.approx([2 * math.pi / period for period in periods], rel=2e-3)


def test_a_reset_begins_anew(lab: Rig) -> None:
    timed(lab, 2400, 0.1)
    before = newest_bag(lab)
    lab.reset()
    assert lab.latest('stopwatch/reading') is None
    first = lab.wait_for('pendulum/motion', timeout=PATIENCE)
    assert set(first.position) == {0.12}
    assert set(lab.wait_for('jigsaw/pivot', timeout=PATIENCE).rate) == {0.0}
    assert RunBag(before).complete
    assert timed(lab, 2400, 0.1) == pytest.approx(RunBag(before).run.period, abs=1e-3)
    assert newest_bag(lab) != before


def test_a_paused_rig_makes_the_steps_it_is_told(paused: Rig) -> None:
    for name in ('jigsaw/pivot', 'pendulum/motion'):
        drain(paused, name)
    for count in (1, 3, 20):
        paused.step(count)
        assert [drain(paused, name) for name in ('jigsaw/pivot', 'pendulum/motion')] == [count, count]


def test_what_a_time_that_runs_or_stands_cannot_do_is_said(lab: Rig) -> None:
    for wrong, words in ((lab.step, 'pause it'), (lab.resume, 'nothing to resume')):
        with pytest.raises(RigError, match=words):
            wrong()
    lab.pause()
    with pytest.raises(RigError, match='paused already, before run'):
        lab.pause()
    lab.step(2)
    lab.resume()
    assert lab.wait_for('pendulum/motion', timeout=PATIENCE) is not None


def test_news_are_all_that_was_said_once_and_in_order(paused: Rig) -> None:
    paused.news(0)
    paused.step(3)
    news = paused.news()
    said = {
        topic: [step_id.step for name, step_id, _ in news if name == topic]
        for topic in ('jigsaw/pivot', 'pendulum/motion')
    }
    assert said['jigsaw/pivot'] == said['pendulum/motion']
    assert np.diff(said['jigsaw/pivot']).tolist() == [1, 1]
    assert [step_id.step for _, step_id, _ in news] == sorted(step_id.step for _, step_id, _ in news)
    later = paused.news(0)  # a command for the steps to come may be late
    every = [(topic, step_id) for topic, step_id, _ in (*news, *later)]
    assert len(set(every)) == len(every)


def test_news_are_of_the_topics_that_are_asked_for(paused: Rig) -> None:
    paused.news(0)
    paused.step(2)
    assert {topic for topic, _, _ in paused.news(topics=['/jigsaw/pivot'])} == {'jigsaw/pivot'}
    assert 'pendulum/motion' in {topic for topic, _, _ in paused.news(0)}
    with pytest.raises(UsageError, match='is none of'):
        paused.news(0, ['pendulum'])


def test_the_wait_for_news_ends_with_what_is_awaited(lab: Rig) -> None:
    lab.news(0)
    assert 'pendulum/motion' in {topic for topic, _, _ in lab.news(awaited=['pendulum/motion'])}


def test_news_that_end_no_wait_are_not_lost(paused: Rig) -> None:
    paused.news(0)
    paused.step(2)
    news = paused.news(0.1, awaited=['analyser/result'])
    assert np.diff([step_id.step for topic, step_id, _ in news if topic == 'jigsaw/pivot']).tolist() == [1]
    with pytest.raises(UsageError, match='is none of'):
        paused.news(0, awaited=['pendulum'])


def test_who_waits_for_news_can_be_woken(paused: Rig) -> None:
    paused.news(0)
    with ThreadPoolExecutor(1) as other:
        waiting = other.submit(paused.news, 600.0)
        paused.wake()
        assert waiting.result(timeout=180) == []


def test_a_reset_while_time_stands_still(paused: Rig) -> None:
    bag = newest_bag(paused)
    paused.reset()
    paused.reset()
    assert drain(paused, 'pendulum/motion') == 0
    paused.step()
    assert drain(paused, 'pendulum/motion') == 1
    assert RunBag(bag).complete


def test_the_rate_can_be_changed(lab: Rig) -> None:
    try:
        lab.set_rate(2.0)
        lab.wait_for('pendulum/motion', lambda _: drain(lab, 'pendulum/motion') == 0, timeout=PATIENCE)
        begun = time.monotonic()
        for _ in range(20):
            lab.wait_for('pendulum/motion', timeout=PATIENCE)
        # A second, less the half that a rig may be behind and catches up. Flat out it would be a tenth of a second.
        assert time.monotonic() - begun > 0.4
        for wrong in (math.nan, -1.0, 1e9):
            with pytest.raises(UsageError, match='rate'):
                lab.set_rate(wrong)
    finally:
        lab.set_rate(0)


def test_requests_that_cannot_be_are_refused_before_they_are_sent(lab: Rig) -> None:
    for rpm in (math.nan, math.inf, -1, 60_000):
        with pytest.raises(RequestError, match='5000 RPM'):
            lab.request_speed(rpm)
    for angle in (math.nan, math.inf, 1.6):
        with pytest.raises(RequestError, match='quarter turn'):
            lab.release(angle)


def test_a_thousand_requests_from_two_writers_at_once(lab: Rig) -> None:
    """Nonsense among them is refused, what is left changes speeds, and the run is as good as any."""
    context = Context()
    with on_loopback():
        rclpy.init(context=context, domain_id=lab.domain)
        writers = [Node(f'writer_{number}', context=context) for number in range(2)]
    refused: dict[str, int] = {}

    def take_health(array: DiagnosticArray) -> None:
        refused.update({s.name: int(pair.value) for s in array.status for pair in s.values if pair.key == 'refused'})

    writers[0].create_subscription(DiagnosticArray, 'diagnostics', take_health, 10)
    speeds = [writer.create_publisher(Float64, 'operator/speed', 10) for writer in writers]
    angles = [writer.create_publisher(Float64, 'operator/release', 10) for writer in writers]
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(writers[0])

    def spin_until(condition: Callable[[], bool]) -> None:
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline
            executor.spin_once(timeout_sec=0.1)

    spin_until(lambda: all(publisher.get_subscription_count() for publisher in (*speeds, *angles)))
    lab.request_speed(1000)
    lab.wait_for('operator/command', lambda command: command.speed == 1000 * RPM, PATIENCE)
    nonsense = (math.nan, math.inf, -math.inf, -5.0, 1e308)
    for count in range(1000):
        for speed, angle in zip(speeds, angles, strict=True):
            speed.publish(Float64(data=nonsense[count % 5] if count % 2 else 200.0 + count % 7))
            angle.publish(Float64(data=nonsense[count % 3] if count % 2 else 0.01))
    lab.request_speed(2500)
    lab.wait_for('strobe/reading', lambda reading: abs(reading.speed / RPM - 2500) < 1, PATIENCE)
    lab.release(0.12)
    truth = 2 * math.pi / slow_frequency_nonlinear(Plant(), 2500 * RPM, 0.12)
    # One of the swings before may come to its end first.
    lab.wait_for('stopwatch/reading', lambda reading: reading.displayed / 3 == pytest.approx(truth, rel=2e-3), PATIENCE)
    spin_until(lambda: refused.get('operator: health', 0) > 0)
    executor.shutdown()
    for writer in writers:
        writer.destroy_node()
    context.try_shutdown()
    bag = newest_bag(lab)
    lab.reset()
    commands = [registry.COMMAND.decode(raw) for _, _, raw in RunBag(bag).raw(registry.COMMAND.name)]
    assert {command.speed for command in commands} <= {
        0.0,
        *(200.0 + n for n in range(7)),
        *(rpm * RPM for rpm in (1000, 2500)),
    }
    assert {command.hold for command in commands} <= {None, 0.01, 0.12}
    assert RunBag(bag).motion.gaps == 0


@pytest.mark.parametrize(('role', 'topic'), [('operator', 'operator/command'), ('recorder', 'recorder/written')])
def test_a_node_that_hangs_is_named_and_may_go_on(lab: Rig, role: str, topic: str) -> None:
    lab.processes[role].end(signal.SIGSTOP)
    try:
        assert lab.processes['jigsaw'].wait_for_line(f'waits for {topic}', 10.0)
    finally:
        lab.processes[role].end(signal.SIGCONT)
    drain(lab, 'pendulum/motion')
    assert timed(lab, 2400, 0.1) > 0.5
    bag = newest_bag(lab)
    lab.reset()
    assert RunBag(bag).motion.gaps == 0


def test_what_does_not_come_and_what_is_not_there(lab: Rig) -> None:
    with pytest.raises(TimeoutError, match=r'stopwatch/reading that fits did not come within 0.2 s'):
        lab.wait_for('stopwatch/reading', timeout=0.2)
    with pytest.raises(UsageError, match='pendulum/angle'):
        lab.wait_for('pendulum/angle')
    with pytest.raises(UsageError, match='barometer'):
        Rig(nodes=('jigsaw', 'barometer'))


def test_a_death_is_told_at_once() -> None:
    with Rig() as rig:
        rig.wait_for('pendulum/motion', timeout=PATIENCE)
        pids = [process.pid for process in rig.processes.values()]
        rig.processes['stopwatch'].end(signal.SIGKILL)
        with pytest.raises(RigError, match='stopwatch was killed by SIGKILL'):
            rig.wait_for('stopwatch/reading', timeout=600)
        with pytest.raises(RigError, match='stopwatch was killed by SIGKILL'):
            rig.latest('pendulum/motion')
    assert not [pid for pid in pids if Path(f'/proc/{pid}').exists()]
    assert not rig.bags.exists()


def test_of_several_deaths_the_first_is_told_also_where_all_are_known_before_anybody_waits() -> None:
    with Rig() as rig:
        rig.wait_for('pendulum/motion', timeout=PATIENCE)
        for role in ('pendulum', 'jigsaw'):
            process = rig.processes[role]
            process.end(signal.SIGKILL)
            assert select.select([process.sentinel], [], [], PATIENCE)[0]
            assert process.status() == -signal.SIGKILL
        with pytest.raises(RigError, match='pendulum was killed by SIGKILL'):
            rig.wait_for('stopwatch/reading', timeout=5.0)


@pytest.mark.slow
def test_four_rigs_at_once() -> None:
    """Each in a domain of its own: what is asked of one is read there and nowhere else."""
    speeds = (1500, 2000, 2500, 3000)
    with contextlib.ExitStack() as stack:
        rigs = [stack.enter_context(Rig(instruments='ideal', rate=5)) for _ in speeds]
        assert len({rig.domain for rig in rigs}) == len(speeds)
        for rig, rpm in zip(rigs, speeds, strict=True):
            rig.request_speed(rpm)
        for rig, rpm in zip(rigs, speeds, strict=True):
            assert rig.wait_for('strobe/reading', timeout=180).speed == pytest.approx(rpm * RPM, rel=1e-8)


@pytest.mark.slow
def test_six_rigs_at_once_start_and_stop_ten_times(shared_memory_of: Callable[..., set[Path]]) -> None:
    """As fast as they can: they are load enough to one another. No node dies, and nothing is left."""

    def work(_: int) -> tuple[list[int], set[Path]]:
        with Rig() as rig:
            pids = [process.pid for process in rig.processes.values()]
            rig.request_speed(2500)
            rig.wait_for('jigsaw/pivot', lambda pivot: pivot.position.any(), timeout=300)
            return pids, shared_memory_of(pids)

    for _ in range(10):
        with ThreadPoolExecutor(6) as threads:
            left = list(threads.map(work, range(6)))
        assert len({pid for pids, _ in left for pid in pids}) == 6 * len(registry.ROLE_NAMES)
        assert not [pid for pids, _ in left for pid in pids if Path(f'/proc/{pid}').exists()]
        assert not [segment for _, segments in left for segment in segments if segment.exists()]


def test_rigs_side_by_side_and_a_reset_of_a_protocol(
    tmp_path: Path, eventually: Callable[[Callable[[], Any]], None]
) -> None:
    """A protocol's run that was reset is done again, at the same speed."""
    protocol = tmp_path / 'one.yaml'
    protocol.write_text('speeds: [2240]')
    with Rig(protocol=str(protocol), bags=tmp_path / 'A', rate=1) as one, Rig(rate=5) as two:
        assert one.domain != two.domain
        one.wait_for('pendulum/motion', timeout=PATIENCE)
        one.reset()
        eventually(lambda: one.reset_runs == (1,))
        one.set_rate(0)
        two.request_speed(2500)
        one.wait_for('analyser/result', lambda result: 'experiment' in result, timeout=PATIENCE)
        with pytest.raises(UsageError, match='carries out the protocol'):
            one.request_speed(2000)
        assert two.wait_for('strobe/reading', timeout=PATIENCE).speed == pytest.approx(2500 * RPM, abs=1.5)
    bags = [RunBag(path) for path in sorted((tmp_path / 'A').iterdir())]
    assert [bag.path.name for bag in bags] == ['run_01_2240rpm', 'run_02_2240rpm']
    assert [bag.run.period is None for bag in bags] == [True, False]
    assert all(bag.complete and not bag.motion.gaps for bag in bags)


def test_a_rig_that_does_not_run_says_so(tmp_path: Path) -> None:
    """On a rig left before, a call met a closed file descriptor; entered twice, the program ended by SIGABRT."""
    rig = Rig(nodes=(), bags=tmp_path)
    for use in (lambda: rig.request_speed(2500), rig.pause, lambda: rig.wait_for('strobe/reading')):
        with pytest.raises(UsageError, match='does not run'):
            use()
    with pytest.raises(UsageError, match='does not run'):
        rig.latest('strobe/reading')
    with rig:
        domain = rig.domain
        with pytest.raises(UsageError, match='entered already'), rig:
            pass
        assert rig.domain == domain
    with pytest.raises(UsageError, match='does not run'):
        rig.news()
    assert rig.latest('strobe/reading') is None


@pytest.mark.parametrize('domain', ['7', 1.5, True, -1, 500])
def test_what_is_no_domain_is_refused(domain: object) -> None:
    with pytest.raises(UsageError, match='give a number from 0 to 101'), Rig(nodes=(), domain=domain):  # type: ignore[arg-type]
        pass


def test_a_program_that_takes_warnings_for_errors_can_have_a_rig() -> None:
    """As a test suite with `filterwarnings = error`: rclpy imports modules that Python has deprecated."""
    program = "from kapitsa_ros.rig import Rig\nwith Rig(nodes=()): print('entered')"
    done = subprocess.run(
        [sys.executable, '-W', 'error', '-c', program], capture_output=True, text=True, timeout=180, check=False
    )
    assert (done.returncode, done.stdout) == (0, 'entered\n'), done.stderr
