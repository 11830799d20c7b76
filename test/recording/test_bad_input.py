"""Files with anything wrong in them: one typed error, or a stated recovery; never another number without a word."""

import struct
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import lz4.frame
import pytest
import zstandard
from bag_of_a_made_up_run import SETTINGS, write
from mutations import REFUSED, SAID, SAME, meaning, mutants, outcome
from rosbags.rosbag2 import Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from kapitsa_ros.laboratory.bag_analysis import analyse_motions, origin
from kapitsa_ros.laboratory.verification import verify_run
from kapitsa_ros.network.settings import encode_settings
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.export_files import export
from kapitsa_ros.recording.reader import RunBag

STORAGES = ['mcap', 'sqlite3']
OTHER_SETTINGS = SETTINGS | {'strobe': '{"seed": 2}'}
STORE = get_typestore(Stores.ROS2_JAZZY)


def storage_file(bag: Path) -> Path:
    [found] = (path for path in bag.iterdir() if path.suffix != '.yaml')
    return found


def outcomes(folder: Path, storage: str, name: str, count: int, seed: int) -> Counter[str]:
    """Return what reading comes to of so many bags that differ from one in the bytes of a file."""
    bag = write(folder / 'run', storage=storage, samples=10)
    other = write(folder / 'other' / 'run', storage=storage, samples=10, settings=OTHER_SETTINGS)
    right = meaning(RunBag(bag))
    changed, foreign = ((each / name if name else storage_file(each)) for each in (bag, other))
    whole = changed.read_bytes()
    found: Counter[str] = Counter()
    for how, bent in mutants(whole, foreign.read_bytes(), count, seed):
        changed.write_bytes(bent)
        result = outcome(bag, right)
        assert result in (SAME, SAID, REFUSED), how
        assert bent != whole or result == SAME, how
        found[result] += 1
    changed.write_bytes(whole)
    assert outcome(bag, right) == SAME
    return found


@pytest.mark.parametrize('name', ['', 'metadata.yaml'])
@pytest.mark.parametrize('storage', STORAGES)
def test_no_change_of_the_bytes_gives_another_result_in_silence(tmp_path: Path, storage: str, name: str) -> None:
    found = outcomes(tmp_path, storage, name, 250, 1997)
    assert len(found) == 3, 'some changes are harmless, some are said, some are refused'


@pytest.mark.slow
@pytest.mark.parametrize('name', ['', 'metadata.yaml'])
@pytest.mark.parametrize('storage', STORAGES)
def test_a_hundred_thousand_changes(
    tmp_path: Path, storage: str, name: str, record_property: Callable[[str, object], None]
) -> None:
    found = outcomes(tmp_path, storage, name, 25_000, 1998)
    record_property('outcomes', dict(found))
    assert found.total() == 25_000


@pytest.mark.slow
@pytest.mark.parametrize('storage', STORAGES)
def test_cut_at_every_byte_and_every_byte_flipped(
    tmp_path: Path, storage: str, record_property: Callable[[str, object], None]
) -> None:
    bag = write(tmp_path / 'run', storage=storage, samples=2)
    right = meaning(RunBag(bag))
    changed = storage_file(bag)
    whole = changed.read_bytes()
    found: Counter[str] = Counter()
    for at in range(len(whole)):
        for how, bent in (
            ('cut', whole[:at]),
            ('flipped', whole[:at] + bytes([whole[at] ^ 0xFF]) + whole[at + 1 :]),
        ):
            changed.write_bytes(bent)
            result = outcome(bag, right)
            assert result in (SAME, SAID, REFUSED), f'{how} at {at}: {result}'
            found[f'{how}: {result}'] += 1
    record_property('outcomes', dict(found))
    assert len(found) > 3


def test_exchanged_files_are_refused(tmp_path: Path) -> None:
    bag, other = (write(tmp_path / name / 'run', samples=samples) for name, samples in (('a', 10), ('b', 20)))
    storage_file(bag).write_bytes(storage_file(other).read_bytes())
    with pytest.raises(BagError, match='its messages are not those whose digest its metadata states'):
        _ = RunBag(bag).run


def chunk(data: bytes, compression: str, size: int) -> bytes:
    name = compression.encode()
    body = struct.pack('<QQQI', 0, 0, size, 0) + struct.pack('<I', len(name)) + name
    body += struct.pack('<Q', len(data)) + data
    return struct.pack('<BQ', 6, len(body)) + body


MAGIC = b'\x89MCAP0\r\n'
NOTHING = bytes(2**30)


@pytest.mark.parametrize(
    'content',
    [
        b'',
        MAGIC,
        MAGIC + struct.pack('<BQ', 6, 2**63),
        MAGIC + struct.pack('<BQ', 5, 2**40) + b'x',
        MAGIC + struct.pack('<BQ', 5, 3) + b'abc',
        MAGIC + chunk(zstandard.compress(NOTHING), 'zstd', 2**30),
        MAGIC + chunk(zstandard.compress(NOTHING), 'zstd', 100),
        MAGIC + chunk(zstandard.ZstdCompressor(write_content_size=False).compress(NOTHING[: 2**28]), 'zstd', 100),
        MAGIC + chunk(lz4.frame.compress(NOTHING), 'lz4', 100),
        MAGIC + chunk(b'abc', 'bzip2', 100),
        MAGIC + struct.pack('<BQQQQIIQ', 6, 40, 0, 0, 0, 0, 0, 2**64 - 1),
        MAGIC + chunk(b'', '', 0) * 20_000,
        MAGIC + struct.pack('<BQ', 3, 30) + struct.pack('<HI', 1, 2**32 - 1) + bytes(24),
        b'SQLite format 3\x00' + bytes(100),
        b'\x28\xb5\x2f\xfd' + bytes(20),
        zstandard.compress(NOTHING),
        b'hello',
    ],
    ids=[
        'empty', 'magic', 'length', 'message', 'short', 'large', 'bomb', 'quiet_bomb', 'lz4_bomb', 'unknown',
        'beyond', 'tiny', 'string', 'sqlite', 'zstd', 'file_bomb', 'text',
    ],
)  # fmt: skip
def test_hostile_files_are_refused_in_a_line(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / 'run_0.mcap'
    file.write_bytes(content)
    for path in (file, tmp_path):
        with pytest.raises(BagError) as error:
            RunBag(path)
        assert '\n' not in str(error.value)


def test_damaged_motion_does_not_reach_the_fit(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Numbers that are finite and absurd, in a bag without digests: numeric libraries would print of their own."""
    shipped = Path(__file__).parents[2] / 'bags' / 'run_02_2640rpm'
    with (
        Reader(shipped) as reader,
        Writer(tmp_path / 'run', version=9, storage_plugin=StoragePlugin.MCAP) as writer,
    ):
        links = {}
        for link, stamp, raw in reader.messages():
            if link.topic not in links:
                links[link.topic] = writer.add_connection(link.topic, link.msgtype, typestore=STORE)
            bent = bytearray(raw)
            if link.topic == '/pendulum/motion' and len(raw) > 5000:
                bent[-45] = 0x7F  # the exponent of the last angle
            writer.write(links[link.topic], stamp, bytes(bent))
    with pytest.raises(BagError, match='is none'):
        analyse_motions([tmp_path / 'run'])
    assert capfd.readouterr() == ('', '')


@pytest.mark.parametrize(
    ('role', 'text', 'why'),
    [
        ('strobe', '[1]', 'strobe: no JSON object'),
        ('jigsaw', 'amplitude', 'jigsaw: no JSON'),
        ('strobe', '{"seed": "1"}', 'strobe: seed is no whole number from 0 on: "1"'),
        ('stopwatch', '{"seed": 1.5}', 'stopwatch: seed is no whole number'),
        ('strobe', '{"seed": 1, "instrument": null}', 'strobe: instrument is no JSON object: null'),
        ('jigsaw', '{"amplitude": 0.0127, "versions": 3}', 'jigsaw: versions is no JSON object: 3'),
        ('pendulum', '{"plant": [1]}', r'pendulum: plant is no JSON object: \[1\]'),
    ],
)
def test_settings_of_another_shape_are_refused(tmp_path: Path, role: str, text: str, why: str) -> None:
    """They are intact, so that no digest tells: somebody's own node has written them."""
    bag = RunBag(write(tmp_path / 'run', samples=10, settings=SETTINGS | {role: text}))
    for use in (verify_run, lambda bag: bag.run, lambda bag: export(bag, 'csv', tmp_path / 'run.csv')):
        with pytest.raises(BagError, match=f'run is damaged: the settings of {why}'):
            use(bag)
    assert not (tmp_path / 'run.csv').exists()


def test_a_motion_needs_no_settings_of_the_instruments(tmp_path: Path) -> None:
    """A rig of somebody's own may have instruments that say nothing of themselves."""
    assert origin([RunBag(write(tmp_path / 'run', samples=10)).run])['instruments'] == {
        'strobe': None,
        'stopwatch': None,
    }


def bag_of(path: Path, *messages: tuple[str, str, bytes]) -> Path:
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for number, (topic, kind, raw) in enumerate(messages):
            writer.write(writer.add_connection(topic, kind, typestore=STORE), number, raw)
    return path


def test_wrong_types_on_our_topics_are_no_run(tmp_path: Path) -> None:
    names = ['/operator/command', '/strobe/reading', '/stopwatch/reading', '/pendulum/settings', '/jigsaw/settings']
    names += ['/strobe/settings', '/stopwatch/settings']
    bag = bag_of(tmp_path / 'run', *((name, 'std_msgs/msg/String', encode_settings('{}')) for name in names))
    with pytest.raises(BagError, match='is no run of this rig: operator/command is of type std_msgs/msg/String, not'):
        RunBag(bag)


def test_a_name_with_spaces_and_other_scripts(tmp_path: Path) -> None:
    for storage in STORAGES:
        bag = RunBag(write(tmp_path / f'прогон 1 ?#%&日本 {storage}', storage=storage))
        assert bag.run.complete
        assert bag.integrity.ok


@pytest.mark.parametrize('storage', STORAGES)
def test_a_bag_on_a_disk_that_cannot_be_written_is_read(tmp_path: Path, storage: str) -> None:
    bag = write(tmp_path / 'run', storage=storage)
    before = {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in bag.iterdir()}
    bag.chmod(0o500)
    try:
        assert RunBag(bag).run.complete
        assert {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in bag.iterdir()} == before
    finally:
        bag.chmod(0o700)


def doubled(form: str) -> str:
    """Return lines of which each holds the one before twice."""
    return ''.join(form.format(name=f'a{n}', last=f'a{n - 1}') for n in range(1, 25))


BOMBS = {
    'nested': '[' * 5000,
    'nested mapping': '{a: ' * 5000,
    'aliases': 'a0: &a0 [x, x]\n' + doubled('{name}: &{name} [*{last}, *{last}]\n'),
    'merges': 'a0: &a0 {x: 1}\n' + doubled('{name}: &{name} {{<<: [*{last}, *{last}]}}\n'),
    'within itself': '&a [*a]',
}


@pytest.mark.parametrize('bomb', BOMBS.values(), ids=BOMBS)
def test_a_bomb_in_metadata_is_said_and_the_bag_is_read(tmp_path: Path, bomb: str) -> None:
    bag = write(tmp_path / 'run')
    (bag / 'metadata.yaml').write_text(bomb)
    opened = RunBag(bag)
    assert opened.run.complete
    assert 'metadata.yaml cannot be used: it is not YAML' in opened.defects[0]


@pytest.mark.parametrize('lie', ['[]', 'x', '', 'rosbag2_bagfile_information: 7', 'version: 9', 'version: 10'])
def test_metadata_that_is_none_is_said(tmp_path: Path, lie: str) -> None:
    bag = write(tmp_path / 'run')
    (bag / 'metadata.yaml').write_text(lie)
    opened = RunBag(bag)
    assert opened.run.complete
    assert 'metadata.yaml cannot be used: ' in opened.defects[0]
