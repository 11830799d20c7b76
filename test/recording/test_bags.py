"""Bags: written step by step, read back, and refused where they are none."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from kapitsa_ros.instruments.stopwatch import StopwatchReading
from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.network import registry
from kapitsa_ros.network.settings import encode_settings
from kapitsa_ros.network.step_clock import SECOND, StepClock
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.operator.command import Command
from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.naming import refuse_existing, run_folders, run_name
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.recording.writer import RunWriter
from kapitsa_ros.units import RPM

CLOCK = StepClock(SECOND // 10)
SETTINGS = {
    'jigsaw': '{"amplitude": 0.0127}',
    'pendulum': '{"plant": {"length": 0.24765}}',
    'strobe': '{"seed": 1}',
    'stopwatch': '{"swings": 3}',
}


def step_messages(step_id: StepId) -> dict[str, bytes]:
    """Return the messages of a step of a made-up run: let go at step 4, both readings at step 8."""
    stamp = CLOCK.start_ns(step_id)
    if step_id.end:
        return {topic.name: topic.codec.encode_silence(stamp, step_id) for topic in registry.RECORDED[1:]}
    time = CLOCK.start(step_id) + np.linspace(0.0, 0.1, 101)
    motion = SampledMotion(0.001, np.sin(time), np.cos(time), -np.sin(time))
    read = step_id.step == 8
    strobe = StrobeReading(time=CLOCK.start(step_id), speed=234.0) if read else None
    timed = StopwatchReading(pressed_at=CLOCK.start(step_id), displayed=1.5, swings=3, kind='timed') if read else None
    return {
        registry.COMMAND.name: registry.COMMAND.encode(
            stamp, step_id, Command(2240 * RPM, 0.12 if step_id.step < 4 else None)
        ),
        registry.PIVOT.name: registry.PIVOT.encode(stamp, step_id, motion),
        registry.MOTION.name: registry.MOTION.encode(stamp, step_id, motion),
        registry.STROBE_READING.name: registry.STROBE_READING.encode(stamp, step_id, strobe),
        registry.STOPWATCH_READING.name: registry.STOPWATCH_READING.encode(stamp, step_id, timed),
        registry.RESULT.name: registry.RESULT.codec.encode_silence(stamp, step_id),
    }


def write(path: Path, *, storage: str = 'mcap', leave_out: int | None = None, end: bool = True) -> Path:
    writer = RunWriter(path, storage, SETTINGS, steps_a_chunk=5)
    for step in range(12):
        if step != leave_out:
            writer.write_step(CLOCK.start_ns(StepId(1, step)), step_messages(StepId(1, step)))
    if end:
        writer.write_step(CLOCK.start_ns(StepId(1, 12)), step_messages(StepId(1, 12, end=True)))
    writer.close(complete=end)
    return path


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_a_run_comes_back(tmp_path: Path, storage: str) -> None:
    bag = RunBag(write(tmp_path / 'run_01_2240rpm', storage=storage))
    assert bag.run.complete
    assert bag.run.speed_asked == 2240 * RPM
    assert bag.run.release == 0.12
    assert bag.run.speed_reading == 234.0
    assert bag.run.period == 0.5
    assert bag.run.plant.length == 0.24765
    assert bag.motion.angle.size == 1201
    assert bag.motion.gaps == 0
    assert bag.motion.angle[-1] == pytest.approx(np.sin(1.2), abs=1e-15)
    assert bag.settings_texts == SETTINGS


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_equal_runs_give_equal_bytes(tmp_path: Path, storage: str) -> None:
    files = [sorted(write(tmp_path / side / 'run', storage=storage).iterdir()) for side in 'ab']
    for left, right in zip(*files, strict=True):
        assert left.name == right.name
        assert left.read_bytes() == right.read_bytes()


def test_latched_topics_say_so_in_the_bag(tmp_path: Path) -> None:
    with Reader(write(tmp_path / 'run')) as reader:
        durability = {c.topic: c.ext.offered_qos_profiles[0].durability.name for c in reader.connections}
    assert durability['/pendulum/settings'] == 'TRANSIENT_LOCAL'
    assert durability['/pendulum/motion'] == 'VOLATILE'


def test_a_lost_step_is_a_gap_and_no_run(tmp_path: Path) -> None:
    bag = RunBag(write(tmp_path / 'run', leave_out=5))
    assert bag.motion.gaps == 1
    with pytest.raises(BagError, match='run 1 step 6 came after run 1 step 4'):
        _ = bag.run


def test_an_interrupted_run_can_be_read_and_says_so(tmp_path: Path) -> None:
    assert not RunBag(write(tmp_path / 'run', end=False)).run.complete


def test_a_crash_costs_at_most_a_chunk(tmp_path: Path) -> None:
    """After a kill the file is no bag, but all chunks but the last are on disk."""
    path = tmp_path / 'run'
    script = (
        'import os, signal, sys; sys.path.insert(0, sys.argv[2]); from pathlib import Path; import test_bags as t\n'
        'writer = t.RunWriter(Path(sys.argv[1]), "mcap", t.SETTINGS, 5)\n'
        'for step_id in [t.StepId(1, step) for step in range(12)]:\n'
        '    writer.write_step(t.CLOCK.start_ns(step_id), t.step_messages(step_id))\n'
        'os.kill(os.getpid(), signal.SIGKILL)'
    )
    subprocess.run([sys.executable, '-c', script, str(path), str(Path(__file__).parent)], check=False)
    whole = write(tmp_path / 'whole')
    on_disk = (path / 'run.mcap').read_bytes()
    # The name of the file is not in its chunks, so the first two of them must be there byte for byte.
    assert len(on_disk) > 0.5 * (whole / 'whole.mcap').stat().st_size
    assert (whole / 'whole.mcap').read_bytes().startswith(on_disk)
    with pytest.raises(BagError, match='never finished'):
        RunBag(path)


def test_what_is_no_bag_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BagError, match='give the folder of a run'):
        RunBag(tmp_path / 'nowhere')
    (tmp_path / 'empty').mkdir()
    with pytest.raises(BagError, match='is no bag'):
        RunBag(tmp_path / 'empty')
    (tmp_path / 'empty' / 'metadata.yaml').write_text('hello: [')
    with pytest.raises(BagError, match='cannot be read'):
        RunBag(tmp_path / 'empty')


def test_a_bag_of_something_else_is_refused(tmp_path: Path) -> None:
    with Writer(tmp_path / 'other', version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection(
            '/chatter', 'std_msgs/msg/String', typestore=get_typestore(Stores.ROS2_JAZZY)
        )
        writer.write(connection, 1, encode_settings('hello'))
    with pytest.raises(BagError, match='lacks operator/command, strobe/reading'):
        RunBag(tmp_path / 'other')


def test_a_damaged_bag_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / 'run') / 'run.mcap'
    raw = path.read_bytes()
    path.write_bytes(raw[: len(raw) // 2])
    with pytest.raises(BagError):
        _ = RunBag(path.parent).run


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_a_bag_bent_anywhere_is_refused_or_read(tmp_path: Path, storage: str) -> None:
    """No damage, wherever it is, ends in anything but a run or a BagError."""
    path = next(file for file in write(tmp_path / 'run', storage=storage).iterdir() if file.suffix != '.yaml')
    whole = path.read_bytes()
    chance = np.random.default_rng(1997)
    refused = 0
    for _ in range(30):
        bent = bytearray(whole)
        for at in chance.integers(0, len(bent), 8):
            bent[at] = chance.integers(256)
        path.write_bytes(bytes(bent))
        try:
            bag = RunBag(path.parent)
            _ = bag.run, bag.motion, bag.complete
        except BagError:
            refused += 1
    assert refused
    path.write_bytes(whole)
    assert RunBag(path.parent).complete


def test_existing_runs_are_not_overwritten(tmp_path: Path) -> None:
    write(tmp_path / run_name(2, 2640 * RPM))
    refuse_existing(tmp_path, [2240 * RPM])
    with pytest.raises(BagError, match='run_02_2640rpm exists'):
        refuse_existing(tmp_path, [2240 * RPM, 2640 * RPM])
    with pytest.raises(BagError, match='cannot write'):
        RunWriter(tmp_path / run_name(2, 2640 * RPM), 'mcap', SETTINGS, 5)


def test_a_bag_states_its_format_and_one_of_the_future_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / 'run_01_2240rpm')
    assert RunBag(path).format == 1
    assert RunBag(Path(__file__).parents[2] / 'bags' / 'run_01_2240rpm').format == 0, 'shipped before bags had one'
    metadata = path / 'metadata.yaml'
    text = metadata.read_text()
    assert "format: '1'" in text
    metadata.write_text(text.replace("format: '1'", "format: '2'"))
    with pytest.raises(BagError, match='has format 2, this version reads up to 1: install a newer'):
        RunBag(path)


def test_a_bag_is_opened_by_a_text_too_and_says_what_it_is(tmp_path: Path) -> None:
    path = write(tmp_path / 'run_01_2240rpm')
    bag = RunBag(str(path))
    assert bag.run.period == 0.5
    assert repr(bag) == f'RunBag({str(path)!r}, {bag.messages} messages)'


def test_a_folder_of_runs_stands_for_its_runs_in_their_order(tmp_path):
    for name in ('run_10_2240rpm', 'run_02_2640rpm', 'no_run'):
        (tmp_path / name).mkdir()
    for name in ('run_10_2240rpm', 'run_02_2640rpm'):
        (tmp_path / name / 'metadata.yaml').touch()
    runs = (tmp_path / 'run_02_2640rpm', tmp_path / 'run_10_2240rpm')
    assert run_folders([tmp_path]) == runs
    assert run_folders([runs[1], tmp_path / 'nowhere']) == (runs[1], tmp_path / 'nowhere')
    assert run_folders([tmp_path / 'no_run']) == (tmp_path / 'no_run',)
