"""The operator's commands follow from the readings, and from nothing else."""

from pathlib import Path

import pytest

from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.instruments.stopwatch import StopwatchReading
from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.operator.command import Command
from kapitsa_ros.operator.errors import ProtocolError
from kapitsa_ros.operator.protocol import Protocol
from kapitsa_ros.operator.scripted_operator import ScriptedOperator
from kapitsa_ros.units import RPM

SPEED = 2240 * RPM
DIAL = StrobeReading(time=3.0, speed=SPEED)


def timed(kind: str = 'timed') -> StopwatchReading:
    return StopwatchReading(pressed_at=9.0, displayed=3.0, swings=3, kind=kind)  # type: ignore[arg-type]


def test_speed_first_then_as_many_timings_as_asked() -> None:
    operator = ScriptedOperator(Protocol(speeds=(SPEED,), release=0.12, repeats=2), (SPEED,), 0.1)
    held, free = Command(SPEED, 0.12), Command(SPEED, None)
    assert operator.opening() == held
    assert [operator.command(None, None) for _ in range(9)] == [held] * 9
    assert operator.command(DIAL, None) == free
    assert operator.command(None, None) == free
    caught = [operator.command(None, timed())] + [operator.command(None, None) for _ in range(5)]
    assert caught == [held] * 5 + [free]
    assert operator.command(None, timed()).end
    assert operator.command(None, None).end


def test_a_swing_that_stopped_too_soon_is_tried_from_farther_out() -> None:
    operator = ScriptedOperator(Protocol(speeds=(SPEED,), release=0.12), (SPEED,), 0.1)
    operator.command(DIAL, None)
    angles = [operator.command(None, timed('stopped')).hold]
    for _ in range(2):
        while operator.command(None, None).hold is not None:
            pass
        angles.append(operator.command(None, timed('stopped')).hold)
    assert angles == [0.24, 0.48, 0.96]
    while operator.command(None, None).hold is not None:
        pass
    assert operator.command(None, timed('stopped')).end


def test_a_pendulum_that_fell_is_not_tried_again() -> None:
    operator = ScriptedOperator(Protocol(speeds=(SPEED,)), (SPEED,), 0.1)
    operator.command(DIAL, None)
    assert operator.command(None, timed('fell')).end


def test_patience_ends() -> None:
    operator = ScriptedOperator(Protocol(speeds=(SPEED,)), (SPEED,), 1.0)
    commands = [operator.command(None, None) for _ in range(310)]
    assert not commands[290].end
    assert commands[-1].end


def test_the_protocol_of_1997() -> None:
    protocol = load_protocol('1997')
    assert [round(speed / RPM) for speed in protocol.speeds] == [2240, 2640, 2780]
    assert (protocol.release, protocol.swings, protocol.repeats) == (0.12, 3, 1)


@pytest.mark.parametrize(
    ('text', 'complaint'),
    [
        ('speeds: [2240 rpm, fast]', "'fast' is not a number"),
        ('speeds: [null]', 'None is not a number'),
        ('speeds: [true]', 'True is not a number'),
        ('speeds: [1/0 Hz]', 'is not a number'),
        ('speeds: [2240]\nrelease: [1]', r'release is \[1\]: give a finite number in rad'),
        ('speeds: []', 'one or more positive speeds'),
        ('speeds: [-3]', 'one or more positive speeds'),
        ('speeds: [.nan]', 'one or more positive speeds'),
        ('speeds: 2240', 'a list of speeds'),
        ('speeds: [2240]\nswings: 0', 'swings is 0: it must lie in'),
        ('speeds: [2240]\nswings: 2.5', 'swings is 2.5: give a whole number'),
        ('speeds: [2240]\nrelease: 3', 'release is 3.0: it must lie in'),
        ('speeds: [2240]\nrelease: three', "release is 'three': give a finite number"),
        ('speeds: [2240]\nswing: 3', 'no parameter swing'),
        ('speeds: [2240', 'is not YAML'),
        ('- 1', 'names and values'),
    ],
)
def test_a_bad_protocol_is_refused_by_name(tmp_path: Path, text: str, complaint: str) -> None:
    path = tmp_path / 'mine.yaml'
    path.write_text(text)
    with pytest.raises(ProtocolError, match=complaint):
        load_protocol(str(path))


def test_an_unknown_protocol_names_the_known() -> None:
    with pytest.raises(ProtocolError, match='1997'):
        load_protocol('1998')
