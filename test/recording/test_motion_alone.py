"""θ(t) read without the rest of a bag: the same numbers to the last bit, and never others without a word."""

import struct
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
import yaml
from bag_of_a_made_up_run import CLOCK, SETTINGS, step_messages, write
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mutations import numbers
from rosbags.rosbag2 import Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from kapitsa_ros.network import registry
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.recording.sealed_motion import read_motion
from kapitsa_ros.recording.writer import RunWriter

SHIPPED = Path(__file__).parents[2] / 'bags'


def storage_file(bag: Path) -> Path:
    [found] = bag.glob('*.mcap')
    return found


def place_of_motion(bag: Path) -> int:
    """Return where in the file the packed content of the first chunk with nothing but motion begins."""
    with storage_file(bag).open('rb') as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    [motion] = [number for number, channel in summary.channels.items() if channel.topic == '/pendulum/motion']
    chunk = next(each for each in summary.chunk_indexes if list(each.message_index_offsets) == [motion])
    return chunk.chunk_start_offset + chunk.chunk_length - chunk.compressed_size


@pytest.mark.parametrize(('storage', 'compression'), [('mcap', 'zstd'), ('mcap', 'none'), ('sqlite3', 'zstd')])
@pytest.mark.parametrize('end', [True, False])
def test_it_is_that_of_the_whole_bag(tmp_path: Path, storage: str, compression: str, *, end: bool) -> None:
    bag = write(tmp_path / 'run', storage=storage, compression=compression, end=end)
    assert numbers(read_motion(bag)) == numbers(RunBag(bag).motion)


@pytest.mark.parametrize('bag', sorted(SHIPPED.glob('run_*')), ids=lambda bag: bag.name)
def test_older_bags_have_the_same_motion(bag: Path) -> None:
    assert numbers(read_motion(bag)) == numbers(RunBag(bag).motion)


def test_numbers_of_more_digits_and_chunks_that_fill_up(tmp_path: Path) -> None:
    """So many steps that their numbers grow, and so many samples that a megabyte does not hold a group."""
    for samples, steps, compression in ((2, 1010, 'zstd'), (5000, 12, 'none')):
        bag = tmp_path / f'{samples}'
        writer = RunWriter(bag, 'mcap', SETTINGS, 5, compression=compression)
        for step in range(steps + 1):
            number = StepId(1, step, end=step == steps)
            writer.write_step(CLOCK.start_ns(number), step_messages(number, samples))
        writer.close(complete=True)
        motion = read_motion(bag)
        assert numbers(motion) == numbers(RunBag(bag).motion)
        assert motion.angle.size == steps * samples + 1
        assert motion.gaps == 0


def test_damage_elsewhere_does_not_matter(tmp_path: Path) -> None:
    bag = write(tmp_path / 'run')
    right, file = numbers(RunBag(bag).motion), storage_file(bag)
    raw = bytearray(file.read_bytes())
    raw[200] ^= 0xFF  # of the first chunk, in which all but the motion is
    file.write_bytes(raw)
    with pytest.raises(BagError):
        _ = RunBag(bag).run
    assert numbers(read_motion(bag)) == right


@pytest.mark.parametrize('compression', ['zstd', 'none'])
def test_a_changed_motion_is_left_out_or_refused(tmp_path: Path, compression: str) -> None:
    """The steps of a damaged chunk are missing then, as in the whole bag; unless the damage is of no sample."""
    bag = write(tmp_path / 'run', compression=compression)
    whole, file = RunBag(bag).motion, storage_file(bag)
    raw, begin = file.read_bytes(), place_of_motion(bag)
    left_out = 0
    for at in range(begin, begin + 400, 7):
        file.write_bytes(raw[:at] + bytes([raw[at] ^ 1]) + raw[at + 1 :])
        try:
            found = read_motion(bag)
        except BagError:
            left_out += 1
            continue
        if numbers(found) != numbers(whole):
            opened = RunBag(bag)
            assert opened.defects
            assert numbers(found) == numbers(opened.motion)
            assert found.lost == pytest.approx(0.5)
            assert np.isin(found.angle, whole.angle).all()
            left_out += 1
    assert left_out > {'zstd': 30, 'none': 10}[compression]


def test_the_digest_is_of_the_samples(tmp_path: Path) -> None:
    """As documented, from the arrays alone: the same in every storage and compression, another after any change."""
    stated = set()
    for storage, compression in (('mcap', 'zstd'), ('mcap', 'none'), ('sqlite3', 'zstd')):
        bag = write(tmp_path / f'{storage}_{compression}', storage=storage, compression=compression)
        custom = yaml.safe_load((bag / 'metadata.yaml').read_text())['rosbag2_bagfile_information']['custom_data']
        stated.add(custom['motion_digest'])
    motion = RunBag(bag).motion
    parts = (sha256(values.astype('<f8').tobytes()).digest() for values in (motion.angle, motion.rate))
    counts = struct.pack('<qqQ', motion.stamps_ns[0], 1_000_000, 1201)
    assert stated == {sha256(counts + b''.join(parts)).hexdigest()}


def test_a_motion_of_another_run_is_refused(tmp_path: Path) -> None:
    bag, other = (write(tmp_path / name / 'run', samples=samples) for name, samples in (('a', 10), ('b', 20)))
    storage_file(bag).write_bytes(storage_file(other).read_bytes())
    with pytest.raises(BagError, match='its messages are not those whose digest its metadata states'):
        read_motion(bag)


@pytest.mark.parametrize(('start', 'size'), [(0, 5000), (0, 9), (0, 2**64 - 1), (2**63 - 1, 5000), (2**64 - 1, 5000)])
def test_an_index_that_points_anywhere_is_not_followed(tmp_path: Path, start: int, size: int) -> None:
    bag = write(tmp_path / 'run')
    right, file = numbers(RunBag(bag).motion), storage_file(bag)
    raw = bytearray(file.read_bytes())
    (summary,) = struct.unpack_from('<Q', raw, len(raw) - 28)
    at = summary
    while at < len(raw) - 8:
        op, length = struct.unpack_from('<BQ', raw, at)
        if op == Opcode.CHUNK_INDEX:
            struct.pack_into('<QQ', raw, at + 9 + 16, start, size)
        at += 9 + length
    file.write_bytes(raw)
    assert numbers(read_motion(bag)) == right


def test_messages_too_short_to_be_numbered_are_left_out(tmp_path: Path) -> None:
    bag = tmp_path / 'run'
    with Writer(bag, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        kind = registry.MOTION.type
        link = writer.add_connection('/pendulum/motion', kind, typestore=get_typestore(Stores.ROS2_JAZZY))
        for stamp in range(3):
            writer.write(link, stamp, bytes(6))
    with pytest.raises(BagError, match='is no run of this rig'):
        read_motion(bag)


@pytest.mark.parametrize('run', [None, 1])
def test_a_run_may_be_named(tmp_path: Path, run: int | None) -> None:
    bag = write(tmp_path / 'run')
    assert read_motion(bag, run).angle.size == 1201
    with pytest.raises(BagError, match='holds runs 1, not 2'):
        read_motion(bag, 2)


def test_others_read_the_chunks_in_order(tmp_path: Path) -> None:
    """The motion stands apart from the rest of its steps; whoever reads by time finds them together."""
    bag = write(tmp_path / 'run')
    with Reader(bag) as reader:
        messages = [(stamp, link.topic) for link, stamp, _ in reader.messages()]
    stamps = [stamp for stamp, _ in messages]
    assert stamps == sorted(stamps)
    assert sum(topic == '/pendulum/motion' for _, topic in messages) == 13
