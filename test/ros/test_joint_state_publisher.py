"""Viewers are shown the motion where there are any."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.ros.joint_state_publisher import JointStatePublisher


@pytest.fixture
def viewers() -> SimpleNamespace:
    return SimpleNamespace(count=0, shown=[])


@pytest.fixture
def publisher(viewers: SimpleNamespace) -> JointStatePublisher:
    def create_publisher(*_: Any) -> SimpleNamespace:
        return SimpleNamespace(publish=viewers.shown.append, get_subscription_count=lambda: viewers.count)

    return JointStatePublisher(SimpleNamespace(create_publisher=create_publisher))


def block() -> tuple[SampledMotion, SampledMotion]:
    return SampledMotion(0.001, *np.zeros((3, 101))), SampledMotion(0.001, *np.full((3, 101), 0.1))


def test_nothing_is_cut_into_frames_or_waited_for_while_nobody_looks(publisher: JointStatePublisher) -> None:
    publisher.offer(0, lambda: pytest.fail('a block was read'))
    assert publisher.refresh() == math.inf


def test_who_comes_while_no_step_does_is_shown_the_end_of_the_last(
    publisher: JointStatePublisher, viewers: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 1000.0
    monkeypatch.setattr('time.monotonic', lambda: now)
    publisher.offer(0, block)
    publisher.refresh()
    viewers.count = 1
    for wait, shown in ((0.5, 0), (0.6, 1), (0.5, 1), (0.6, 2)):
        now += wait
        publisher.refresh()
        assert len(viewers.shown) == shown
    stamps = [(state.header.stamp.sec, state.header.stamp.nanosec) for state in viewers.shown]
    assert stamps == [(0, 100_000_000)] * 2


def test_who_comes_is_shown_what_comes_then(
    publisher: JointStatePublisher, viewers: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 1000.0
    monkeypatch.setattr('time.monotonic', lambda: now)
    publisher.offer(0, block)
    viewers.count = 1
    publisher.refresh()
    assert viewers.shown == []
    now += 0.5
    publisher.offer(100_000_000, block)
    publisher.refresh()
    [first] = viewers.shown
    assert list(first.position) == [0.0, 0.1]
    assert 0.0 < publisher.wait() < 0.1
    now += 1.0
    viewers.count = 0
    publisher.offer(200_000_000, block)
    assert publisher.refresh() == math.inf
    assert viewers.shown == [first]
