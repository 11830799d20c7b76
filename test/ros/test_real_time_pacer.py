"""Simulated against wall time, by a clock that the test turns."""

import pytest

from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.ros import real_time_pacer
from kapitsa_ros.ros.real_time_pacer import LATE, RealTimePacer

STEP = 0.1


class Clock:
    """Stands in for the module `time`."""

    def __init__(self) -> None:
        self.now = 1e6

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(real_time_pacer, 'time', clock)
    return clock


@pytest.mark.parametrize('rate', [0.05, 1.0, 5.0])
def test_steps_are_due_at_the_rate(clock: Clock, rate: float) -> None:
    pacer = RealTimePacer(rate)
    for step in range(100):
        clock.now += max(pacer.wait(step * STEP), 0.0)
        assert pacer.wait(step * STEP) == pytest.approx(0.0, abs=1e-6)
        pacer.count(step * STEP)
    assert clock.now - 1e6 == pytest.approx(99 * STEP / rate)
    assert pacer.simulated == pytest.approx(99 * STEP)
    assert pacer.realtime_factor == pytest.approx(rate)
    assert pacer.step_rate == pytest.approx(rate / STEP)
    assert pacer.misses == 0


def test_rate_0_never_waits(clock: Clock) -> None:
    pacer = RealTimePacer(0.0)
    assert [pacer.wait(step * STEP) for step in range(3)] == [0.0, 0.0, 0.0]
    clock.now += 1e3
    assert pacer.wait(0.3) == 0.0
    assert pacer.misses == 0


def test_a_short_delay_is_caught_up(clock: Clock) -> None:
    pacer = RealTimePacer(1.0)
    pacer.wait(0.0)
    clock.now += 0.9 * LATE
    assert pacer.wait(STEP) == pytest.approx(STEP - 0.9 * LATE)
    assert pacer.wait(LATE) == pytest.approx(0.1 * LATE)
    assert pacer.misses == 0


def test_a_long_delay_is_given_up_once(clock: Clock) -> None:
    pacer = RealTimePacer(1.0)
    pacer.wait(0.0)
    clock.now += STEP + 1.1 * LATE
    assert pacer.wait(STEP) == 0.0
    assert pacer.wait(2 * STEP) == pytest.approx(STEP)
    assert pacer.misses == 1


def test_the_day_between_two_runs_is_not_waited_for(clock: Clock) -> None:
    pacer = RealTimePacer(1.0)
    pacer.wait(1.0)
    pacer.count(1.0)
    clock.now += STEP
    following = 1.0 + DAY / SECOND
    assert pacer.wait(following) == 0.0
    pacer.count(following)
    assert pacer.wait(following + STEP) == pytest.approx(STEP)
    assert pacer.simulated == 0.0
    assert pacer.misses == 0


@pytest.mark.parametrize('change', [RealTimePacer.restart, lambda pacer: setattr(pacer, 'rate', 1.0)])
def test_a_pause_and_a_new_rate_are_not_caught_up(clock: Clock, change) -> None:
    pacer = RealTimePacer(1.0)
    pacer.wait(0.0)
    clock.now += 60.0
    change(pacer)
    assert pacer.wait(STEP) == 0.0
    assert pacer.wait(2 * STEP) == pytest.approx(STEP)
    assert pacer.misses == 0


def test_nothing_has_gone_by_before_the_second_step(clock: Clock) -> None:
    pacer = RealTimePacer(0.0)
    assert (pacer.realtime_factor, pacer.step_rate) == (0.0, 0.0)
    pacer.count(0.0)
    assert (pacer.realtime_factor, pacer.step_rate) == (0.0, 0.0)
    clock.now += 0.02
    pacer.count(STEP)
    assert pacer.realtime_factor == pytest.approx(5.0)
