"""Bags: written step by step, read back, and refused where they are none."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from bag_of_a_made_up_run import SETTINGS, write
from mcap.reader import make_reader
from rosbags.rosbag2 import Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from kapitsa_ros.network.settings import encode_settings
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.naming import refuse_existing, run_folders, run_name
from kapitsa_ros.recording.reader import RunBag, runs_of
from kapitsa_ros.recording.writer import RunWriter
from kapitsa_ros.units import RPM


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


@pytest.mark.parametrize(('left_out', 'lost'), [(5, 0.1), (0, 0.1)])
def test_a_lost_step_is_a_gap_and_is_said(tmp_path: Path, left_out: int, lost: float) -> None:
    bag = RunBag(write(tmp_path / 'run', leave_out=left_out))
    assert bag.motion.gaps == 1
    assert bag.motion.lost == pytest.approx(lost, abs=1.1e-3)
    assert bag.defects == (f'step {left_out} of run 1: missing',)
    assert bag.run.period == 0.5
    with pytest.raises(BagError, match=f'lacks step {left_out} of run 1: a graph needs every step'):
        bag.refuse_gaps()


def test_an_interrupted_run_can_be_read_and_says_so(tmp_path: Path) -> None:
    bag = RunBag(write(tmp_path / 'run', end=False))
    assert not bag.run.complete
    assert bag.defects == ('run 1 has no end: it was interrupted, or what came after step 11 is lost',)


def test_what_is_no_bag_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BagError, match='give the folder of a run'):
        RunBag(tmp_path / 'nowhere')
    (tmp_path / 'empty').mkdir()
    with pytest.raises(BagError, match='is no bag'):
        RunBag(tmp_path / 'empty')
    (tmp_path / 'empty' / 'metadata.yaml').write_text('hello: [')
    with pytest.raises(BagError, match='cannot be read'):
        RunBag(tmp_path / 'empty')


def test_a_run_that_is_given_twice_says_so(tmp_path: Path) -> None:
    """As a copy, or as the file in its folder; the same folder twice is told by its name."""
    first, other = write(tmp_path / 'run'), write(tmp_path / 'other', leave_out=3)
    copy = Path(shutil.copytree(first, tmp_path / 'copy'))
    bags = runs_of([first, other, copy, first / 'run_0.mcap', first])
    assert [bag.repeats for bag in bags] == [None, None, first, first, copy]
    assert any(f'the run is that of {first}, given once more' in defect for defect in bags[2].defects)
    assert not bags[0].defects


def test_a_folder_of_bags_is_called_one(tmp_path: Path) -> None:
    for number in (10, 9):
        write(tmp_path / f'run_{number}')
    with pytest.raises(BagError, match=r'is a folder of 2: give one of them, such as .*/run_9$'):
        RunBag(tmp_path)


def test_a_bag_of_something_else_is_refused(tmp_path: Path) -> None:
    with Writer(tmp_path / 'other', version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection(
            '/chatter', 'std_msgs/msg/String', typestore=get_typestore(Stores.ROS2_JAZZY)
        )
        writer.write(connection, 1, encode_settings('hello'))
    with pytest.raises(BagError, match='lacks operator/command, strobe/reading'):
        RunBag(tmp_path / 'other')


def test_where_what_a_bag_lacks_is_damaged_that_is_said(tmp_path: Path) -> None:
    """Its first chunk holds the settings."""
    file = write(tmp_path / 'run') / 'run_0.mcap'
    raw = bytearray(file.read_bytes())
    with file.open('rb') as opened:
        first = make_reader(opened).get_summary().chunk_indexes[0].chunk_start_offset
    raw[first + 9 + 24] ^= 1  # its checksum
    file.write_bytes(raw)
    with pytest.raises(BagError, match=r'lacks jigsaw/settings, .*; run_0\.mcap: the record at byte .* is damaged'):
        RunBag(tmp_path / 'run')


def test_a_bag_that_was_cut_short_says_so(tmp_path: Path) -> None:
    path = write(tmp_path / 'run') / 'run_0.mcap'
    raw = path.read_bytes()
    path.write_bytes(raw[: len(raw) // 2])
    bag = RunBag(path.parent)
    assert not bag.integrity.ok
    assert not bag.complete
    assert 'run_0.mcap: it was never closed, and ends in the middle of a record' in bag.defects[0]
    assert bag.defects[1].startswith('metadata.yaml counts 80 messages on analyser/result, jigsaw/pivot, ')
    assert ', 57 can be read' in bag.defects[1]


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
    assert RunBag(path).format == 2
    assert RunBag(Path(__file__).parents[2] / 'bags' / 'run_01_2240rpm').format == 0, 'shipped before bags had one'
    metadata = path / 'metadata.yaml'
    text = metadata.read_text()
    assert "format: '2'" in text
    metadata.write_text(text.replace("format: '2'", "format: '3'"))
    with pytest.raises(BagError, match='has format 3, this version reads up to 2: install a newer'):
        RunBag(path)
    metadata.write_text(text.replace("format: '2'", f"format: '{'9' * 5000}'"))
    with pytest.raises(BagError, match='has format 9999999999, this version reads up to 2: install a newer'):
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
