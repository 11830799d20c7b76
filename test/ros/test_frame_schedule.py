"""What viewers see: real samples at even spacing, at the pace of the rig, and no more than they can use."""

import itertools
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kapitsa_ros.network.step_clock import DAY
from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.ros import joint_state_publisher
from kapitsa_ros.ros.frame import Frame
from kapitsa_ros.ros.frame_schedule import FrameSchedule, frame_count
from kapitsa_ros.ros.joint_state_publisher import JointStatePublisher

STEP, STEP_NS, SAMPLE_NS = 0.1, 100_000_000, 1_000_000


@pytest.mark.parametrize(
    ('gap', 'count'),
    [
        (0.1, 5),  # rate 1
        (0.085, 5),  # rate 1 on a busy machine
        (0.16, 5),
        (0.05, 2),  # rate 2
        (0.02, 1),  # rate 5
        (0.002, 1),
        (2.0, 100),  # rate 0.05: every sample
        (4.0, 1),  # a step made by hand
        (math.inf, 1),  # the first of all
    ],
)
def test_a_step_is_cut_into_equal_parts(gap: float, count: int) -> None:
    assert frame_count(100, gap) == count


@given(intervals=st.integers(1, 10_000), gap=st.floats(0, 5))
def test_parts_are_whole_samples_and_no_more_than_60_a_second(intervals: int, gap: float) -> None:
    count = frame_count(intervals, gap)
    assert intervals % count == 0
    assert count == 1 or gap / count >= 1 / 60


def angle_at(stamp_ns: float) -> float:
    return math.sin((stamp_ns - DAY) * 1e-9)


def blocks(step: int) -> tuple[int, SampledMotion, SampledMotion]:
    """Return the stamp of a step and a motion that tells when it is."""
    start = DAY + step * STEP_NS
    stamps = start + np.arange(101) * SAMPLE_NS
    angle = np.array([angle_at(stamp) for stamp in stamps])
    return start, SampledMotion(1e-3, -angle, -2 * angle, angle), SampledMotion(1e-3, angle, 2 * angle, angle)


def shown(gaps: list[float], *, looks: float = 1e-3) -> list[tuple[float, Frame]]:
    """Show a film whose blocks come after gaps of wall time to a screen that is refreshed now and then."""
    film, now, seen = FrameSchedule(), 5.0, []
    for step, gap in enumerate([0.0, *gaps]):
        now += gap
        if film.wants(now):
            film.take(now, *blocks(step))
        until = now + ([*gaps, 3.0][step])
        look = now
        while look < until:
            if (frame := film.due(look)) is not None:
                seen.append((look, frame))
            look += min(looks, film.wait(look))
    return seen


def test_at_rate_1_fifty_frames_a_second_evenly_in_both_times() -> None:
    seen = shown([STEP] * 20)[1:]
    stamps = [frame.stamp_ns for _, frame in seen]
    assert len(seen) == 100
    assert stamps == list(range(stamps[0], stamps[0] + 100 * 20_000_000, 20_000_000))
    assert np.diff([wall for wall, _ in seen]) == pytest.approx(0.02, abs=1e-9)


def test_a_frame_is_the_motion_at_its_stamp() -> None:
    for _, frame in shown([STEP, 2.0, 0.05, 0.02, 3.5, 0.3]):
        angle = angle_at(frame.stamp_ns)
        assert frame.position == (-angle, angle)
        assert frame.velocity == (-2 * angle, 2 * angle)


@given(gaps=st.lists(st.floats(0.001, 4.0), min_size=1, max_size=8), looks=st.floats(0.002, 0.2))
def test_stamps_grow_whatever_the_pace_and_never_faster_than_100_a_second(gaps: list[float], looks: float) -> None:
    seen = shown(gaps, looks=looks)
    stamps = [frame.stamp_ns for _, frame in seen]
    assert all(later > earlier for earlier, later in itertools.pairwise(stamps))
    walls = [wall for wall, _ in seen]
    assert all(walls[index + 100] - walls[index] >= 0.99 for index in range(len(walls) - 100))


def test_before_a_pause_the_end_of_the_last_step_is_shown() -> None:
    for gap in (0.02, STEP, 2.0, 4.0):
        last = shown([gap] * 3)[-1][1]
        assert last.stamp_ns == blocks(4)[0]


def test_at_full_speed_blocks_are_left_out() -> None:
    assert len(shown([0.0005] * 1000)) <= 51


def test_the_last_step_before_time_stands_still_is_shown_however_soon_it_comes(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = itertools.count(100.0, 1e-4)  # s, no step takes longer
    monkeypatch.setattr(joint_state_publisher, 'time', SimpleNamespace(monotonic=lambda: next(clock)))
    states: list[Any] = []
    viewed = SimpleNamespace(publish=states.append, get_subscription_count=lambda: 1)
    publisher = JointStatePublisher(SimpleNamespace(create_publisher=lambda *_: viewed))
    motion = SampledMotion(1e-3, *np.zeros((3, 101)))
    ends = [DAY + number * STEP_NS for number in (1, 2, 3)]
    for number in range(3):
        publisher.offer(DAY + number * STEP_NS, lambda: (motion, motion))
        publisher.refresh()
    waits = [publisher.refresh() for _ in range(10_000)]  # a second
    assert 0.0 < waits[0] < 1.0
    assert waits[-1] == math.inf
    stamps = [state.header.stamp.sec * 10**9 + state.header.stamp.nanosec for state in states]
    assert ends[1] not in stamps
    assert (stamps[0], stamps[-1]) == (ends[0], ends[2])
