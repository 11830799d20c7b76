"""Bytes on the wire, held against rclpy's own and against garbage."""

from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from kapitsa_ros.instruments.stopwatch import StopwatchReading
from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.network import registry
from kapitsa_ros.network.cdr import read_step_id, stamp_of
from kapitsa_ros.network.codecs.motion import MotionCodec
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.network.topic import Topic
from kapitsa_ros.operator.command import Command
from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.ros.qos import message_class

STEP_IDS = [StepId(1, 0), StepId(1, 12), StepId(7, 123), StepId(3, 1234), StepId(12, 99_999), StepId(1, 5, end=True)]
STAMP = DAY + 5 * SECOND + 123_456_789


def samples(count: int = 101) -> SampledMotion:
    return SampledMotion(0.001, *np.random.default_rng(1).normal(size=(3, count)))


@pytest.mark.parametrize('step_id', STEP_IDS, ids=str)
@pytest.mark.parametrize('joint', ['pivot', 'pendulum'])
def test_a_block_is_what_rclpy_reads(step_id: StepId, joint: str) -> None:
    block = samples()
    raw = MotionCodec(joint).encode(STAMP, step_id, block)
    message = deserialize_message(raw, JointTrajectory)
    assert message.joint_names == [joint]
    assert message.header.frame_id == str(step_id)
    assert message.header.stamp.sec * SECOND + message.header.stamp.nanosec == STAMP == stamp_of(raw)
    assert [point.positions[0] for point in message.points] == block.position.tolist()
    assert [point.velocities[0] for point in message.points] == block.rate.tolist()
    assert [point.accelerations[0] for point in message.points] == block.acceleration.tolist()
    assert [point.time_from_start.nanosec for point in message.points] == [i * 1_000_000 for i in range(101)]


def test_a_block_of_rclpy_is_read_alike() -> None:
    block = samples(5)
    points = [
        JointTrajectoryPoint(positions=[p], velocities=[v], accelerations=[a])
        for p, v, a in zip(block.position, block.rate, block.acceleration, strict=True)
    ]
    for i, point in enumerate(points):
        point.time_from_start.nanosec = i * 1_000_000
    # The regular layout, and one with efforts, which only the general way reads.
    for effort in ([], [0.5]):
        for point in points:
            point.effort = effort
        message = JointTrajectory(header=Header(frame_id='run 1 step 0'), joint_names=['pivot'], points=points)
        read = registry.PIVOT.decode(exact(message))
        assert read.period == block.period
        for name in ('position', 'rate', 'acceleration'):
            assert np.array_equal(getattr(read, name), getattr(block, name))


def exact(message: JointTrajectory) -> bytes:
    """Serialise without the spare bytes that rclpy reserves behind a message it does not send."""
    raw = serialize_message(message)
    for spare in range(0, 4096, 4):
        try:
            registry.PIVOT.decode(raw[: len(raw) - spare])
        except WireError:
            continue
        return raw[: len(raw) - spare]
    raise AssertionError("no prefix of rclpy's bytes is a message")


@pytest.mark.parametrize('topic', registry.TOPICS, ids=lambda topic: topic.name)
@pytest.mark.parametrize('step_id', STEP_IDS, ids=str)
def test_silence_is_an_empty_message(topic: Topic[Any], step_id: StepId) -> None:
    raw = topic.codec.encode_silence(STAMP, step_id)
    assert read_step_id(raw) == step_id
    assert topic.codec.is_silence(raw)
    assert topic.codec.is_silence(raw + bytes(-len(raw) % 4)), 'padded as it arrives'
    assert stamp_of(raw) == STAMP


@pytest.mark.parametrize('topic', registry.TOPICS, ids=lambda topic: topic.name)
def test_silence_is_what_rclpy_reads_as_nothing(topic: Topic[Any]) -> None:
    header = Header(frame_id='run 1 step 12')
    kind = message_class(topic.type)
    expected = header if kind is Header else kind(header=header)
    assert deserialize_message(topic.codec.encode_silence(0, StepId(1, 12)), kind) == expected


@pytest.mark.parametrize('command', [Command(234.0, 0.12), Command(234.0, None), Command(0.0, None, end=True)])
def test_commands_come_back(command: Command) -> None:
    raw = registry.COMMAND.encode(STAMP, StepId(2, 7), command)
    assert registry.COMMAND.decode(raw) == command
    message = deserialize_message(raw, JointState)
    held = [] if command.hold is None else ['pendulum']
    assert list(message.name) == ([] if command.end else ['shaft', *held])


@given(st.floats(0, 80_000, allow_nan=False), st.floats(0, 1e4), st.integers(1, 1000))
def test_readings_come_back_to_the_nanosecond(time: float, value: float, swings: int) -> None:
    step_id = StepId(3, 7)
    strobe = registry.STROBE_READING.decode(
        registry.STROBE_READING.encode(STAMP, step_id, StrobeReading(time=time, speed=value))
    )
    assert strobe is not None
    assert strobe.speed == value
    assert strobe.time == pytest.approx(time, abs=1e-9)
    reading = StopwatchReading(pressed_at=time, displayed=value, swings=swings, kind='timed')
    stopwatch = registry.STOPWATCH_READING.decode(registry.STOPWATCH_READING.encode(STAMP, step_id, reading))
    assert stopwatch is not None
    assert (stopwatch.swings, stopwatch.kind) == (swings, 'timed')
    assert stopwatch.displayed == pytest.approx(value, abs=1e-9)
    assert registry.STROBE_READING.decode(registry.STROBE_READING.encode(STAMP, step_id, None)) is None
    assert registry.STOPWATCH_READING.decode(registry.STOPWATCH_READING.encode(STAMP, step_id, None)) is None


def test_results_come_back_digit_for_digit() -> None:
    values = {
        'run 1': {'period_s': 0.1 + 0.2, 'fell': False, 'slow_rpm': None},
        'experiment': {'truth_rpm': 1354.8036386090832},
    }
    assert registry.RESULT.decode(registry.RESULT.encode(STAMP, StepId(1, 5, end=True), values)) == values


@given(st.binary(max_size=200))
def test_garbage_is_refused_by_name(raw: bytes) -> None:
    decoders = [decode for topic in registry.TOPICS for decode in (topic.decode, topic.codec.is_silence)]
    for decode in (read_step_id, *decoders):
        with pytest.raises(WireError):
            decode(raw)


@pytest.mark.parametrize('topic', registry.TOPICS, ids=lambda topic: topic.name)
@given(st.data())
def test_a_message_cut_short_is_refused_by_name_or_says_nothing_else(topic: Topic[Any], data: st.DataObject) -> None:
    step_id = StepId(1, 3)
    values = {
        registry.COMMAND: Command(234.0, 0.12),
        registry.PIVOT: samples(8),
        registry.MOTION: samples(8),
        registry.STROBE_READING: StrobeReading(time=0.5, speed=234.0),
        registry.STOPWATCH_READING: StopwatchReading(pressed_at=0.5, displayed=1.8, swings=3, kind='timed'),
        registry.RESULT: {'run 1': {'period_s': 0.6}},
        registry.WRITTEN: None,
    }
    raw = topic.encode(STAMP, step_id, values[topic])
    cut = raw[: data.draw(st.integers(0, len(raw) - 1))]
    for use in (topic.decode, topic.codec.is_silence, read_step_id, stamp_of):
        with suppress(WireError):
            use(cut)


@pytest.mark.parametrize('kind', ['timed', 'fell', 'stopped'])
def test_a_timing_of_no_swing_is_refused(kind: str) -> None:
    reading = StopwatchReading(pressed_at=0.5, displayed=1.8, swings=0, kind=kind)
    raw = registry.STOPWATCH_READING.encode(STAMP, StepId(1, 3), reading)
    if kind == 'timed':
        with pytest.raises(WireError, match='0 swings'):
            registry.STOPWATCH_READING.decode(raw)
    else:
        assert registry.STOPWATCH_READING.decode(raw) == reading


@given(st.data())
def test_a_cut_or_bent_block_is_refused_or_read(data: st.DataObject) -> None:
    raw = bytearray(registry.PIVOT.encode(STAMP, StepId(1, 3), samples(8)))
    for _ in range(data.draw(st.integers(1, 4))):
        raw[data.draw(st.integers(0, len(raw) - 1))] = data.draw(st.integers(0, 255))
    try:
        block = registry.PIVOT.decode(bytes(raw[: data.draw(st.integers(0, len(raw)))]))
    except WireError:
        return
    assert np.isfinite(block.position).all()


@pytest.mark.parametrize('speed', [np.nan, np.inf, -np.inf])
def test_commands_that_are_not_finite_are_refused(speed: float) -> None:
    with pytest.raises(WireError, match='not finite'):
        registry.COMMAND.decode(registry.COMMAND.encode(STAMP, StepId(1, 0), Command(speed, 0.1)))


@pytest.mark.parametrize(
    ('raw', 'said'),
    [
        (b'', '0 bytes without the header of one'),
        (b'\x00\x01\x00\x00', '4 bytes without the header of one'),
        (b'\x00\x01\x00\x00' + bytes(8) + b'\x03\x00\x00\x00\xff\xfe\x00', 'its number is no text'),
    ],
)
def test_what_has_no_number_is_refused_in_words_of_ours(raw: bytes, said: str) -> None:
    with pytest.raises(WireError, match=f'^not a numbered message: {said}$'):
        read_step_id(raw)


def test_what_is_laid_out_otherwise_is_refused_in_words_of_ours() -> None:
    raw = registry.STROBE_READING.encode(DAY, StepId(1, 0), StrobeReading(time=1.0, speed=2.0))[:-12]
    told = f'^not a sensor_msgs/msg/JointState: its {len(raw)} bytes are laid out otherwise$'
    with pytest.raises(WireError, match=told):
        registry.STROBE_READING.decode(raw)
