"""Requests become commands: the newest before a step, and only what can be."""

import math

import pytest

from kapitsa_ros.operator.command import Command
from kapitsa_ros.operator.errors import RequestError
from kapitsa_ros.operator.manual_operator import ManualOperator
from kapitsa_ros.operator.requests import Requests


@pytest.fixture
def requests() -> Requests:
    return Requests(500.0)


@pytest.fixture
def operator(requests: Requests) -> ManualOperator:
    return ManualOperator(requests, 0.12, 0.1)


def commands(operator: ManualOperator, count: int) -> list[Command]:
    return [operator.command(None, None) for _ in range(count)]


def test_nothing_happens_until_something_is_asked_for(operator: ManualOperator) -> None:
    assert {operator.opening(), *commands(operator, 20)} == {Command(0.0, 0.12)}


def test_the_speed_asked_for_last_holds_on(operator: ManualOperator, requests: Requests) -> None:
    for speed in (100.0, 300.0, 200.0):
        requests.ask_speed(speed)
    assert commands(operator, 3) == [Command(200.0, 0.12)] * 3


def test_a_release_is_half_a_second_in_the_hand_and_then_none(operator: ManualOperator, requests: Requests) -> None:
    requests.ask_release(-0.3)
    assert [command.hold for command in commands(operator, 8)] == [-0.3] * 5 + [None] * 3


def test_a_second_release_begins_anew(operator: ManualOperator, requests: Requests) -> None:
    requests.ask_release(0.1)
    commands(operator, 3)
    requests.ask_release(0.2)
    assert [command.hold for command in commands(operator, 6)] == [0.2] * 5 + [None]


def test_a_request_between_two_runs_waits_for_the_next(requests: Requests) -> None:
    requests.ask_speed(250.0)
    assert ManualOperator(requests, 0.12, 0.1).command(None, None) == Command(250.0, 0.12)


def test_a_run_ends_before_its_day_is_over(requests: Requests) -> None:
    ends = [command.end for command in commands(ManualOperator(requests, 0.12, 100.0), 864)]
    assert not any(ends[:799])
    assert all(ends[799:])


@pytest.mark.parametrize('speed', [math.nan, math.inf, -math.inf, -1.0, 500.1, 1e308])
def test_a_speed_that_cannot_be_is_refused(operator: ManualOperator, requests: Requests, speed: float) -> None:
    with pytest.raises(RequestError, match=r'0 to 4775 RPM \(500 rad/s\)'):
        requests.ask_speed(speed)
    assert commands(operator, 1) == [Command(0.0, 0.12)]


@pytest.mark.parametrize('angle', [math.nan, math.inf, -math.inf, math.pi / 2, -2.0])
def test_an_angle_that_cannot_be_is_refused(operator: ManualOperator, requests: Requests, angle: float) -> None:
    with pytest.raises(RequestError, match='quarter turn'):
        requests.ask_release(angle)
    assert commands(operator, 1) == [Command(0.0, 0.12)]
