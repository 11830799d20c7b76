"""Recordings as other tools lay them out give the numbers of the run that is in them."""

import sqlite3
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
import yaml
import zstandard
from bag_of_a_made_up_run import write as made_up_run
from click.testing import CliRunner
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from mutations import meaning
from rosbags.rosbag2 import CompressionFormat, CompressionMode, Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from kapitsa_ros import read_motion
from kapitsa_ros.cli.commands.bag import bag as bag_command
from kapitsa_ros.laboratory.verification import verify_run
from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.settings import encode_settings
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.export_files import export
from kapitsa_ros.recording.reader import RunBag, open_runs
from kapitsa_ros.recording.recover import recover

SHIPPED = Path(__file__).parents[2] / 'bags'
RUNS = sorted(SHIPPED.glob('run_*'))
SHORT = RUNS[1]
STORE = get_typestore(Stores.ROS2_JAZZY)
STORAGES = ['mcap', 'sqlite3']


class Message(NamedTuple):
    topic: str
    type: str
    stamp: int
    raw: bytes


def messages(*bags: Path) -> Iterator[Message]:
    for bag in bags:
        with Reader(bag) as reader:
            for link, stamp, raw in reader.messages():
                yield Message(link.topic, link.msgtype, stamp, bytes(raw))


def write(
    path: Path, content: Iterable[Message], storage: str = 'mcap', mode: CompressionMode = CompressionMode.NONE
) -> Path:
    writer = Writer(path, version=9, storage_plugin=StoragePlugin[storage.upper()])
    if mode is not CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        links: dict[str, Any] = {}
        for message in content:
            if message.topic not in links:
                links[message.topic] = writer.add_connection(message.topic, message.type, typestore=STORE)
            writer.write(links[message.topic], message.stamp, message.raw)
    return path


def edit(bag: Path, change: Callable[[dict[str, Any]], object]) -> None:
    file = bag / 'metadata.yaml'
    document = yaml.safe_load(file.read_text())
    change(document['rosbag2_bagfile_information'])
    file.write_text(yaml.safe_dump(document))


@pytest.fixture(scope='module')
def right() -> Any:
    return meaning(RunBag(SHORT))


def as_a_live_rig(run: Path) -> Iterator[Message]:
    """Yield what `ros2 bag record -a` makes of a run: stamps of wall time, topics a little apart, others among them."""
    for count, message in enumerate(messages(run)):
        late = 7_000_000 * (count % 5)
        yield message._replace(stamp=1_700_000_000_000_000_000 + count * 1_000_000 + late)
        if count % 50 == 0:
            yield Message('/rosout_of_others', 'std_msgs/msg/String', message.stamp, encode_settings('hello'))


@pytest.mark.parametrize('storage', STORAGES)
def test_a_session_in_one_bag_is_taken_apart(tmp_path: Path, storage: str) -> None:
    session = write(tmp_path / 'session', messages(*RUNS), storage)
    runs = open_runs(session)
    assert [run.number for run in runs] == [1, 2, 3]
    assert [run.name for run in runs] == ['session run 1', 'session run 2', 'session run 3']
    for run, bag in zip(runs, RUNS, strict=True):
        assert meaning(run) == meaning(RunBag(bag))
        assert run.messages == RunBag(bag).messages
        assert run.defects == ()
    with pytest.raises(BagError, match='holds runs 1, 2, 3: take it apart by open_runs'):
        RunBag(session)
    assert meaning(RunBag(session, 2)) == meaning(RunBag(SHORT))
    made = recover(session, tmp_path / 'apart')
    assert [each.bag.name for each in made] == ['session_run_01', 'session_run_02', 'session_run_03']
    assert meaning(RunBag(made[1].bag)) == meaning(RunBag(SHORT))


def test_messages_that_stand_twice_count_once(tmp_path: Path, right: Any) -> None:
    for order in ('pairs', 'one after the other'):
        content = [message for message in messages(SHORT) for _ in range(2)]
        bag = RunBag(write(tmp_path / order, content if order == 'pairs' else [*messages(SHORT), *messages(SHORT)]))
        assert meaning(bag) == right
        assert bag.defects == ('461 messages of run 2 stand there twice, and count once',)


def test_two_different_runs_of_a_number_are_refused(tmp_path: Path) -> None:
    def other() -> Iterator[Message]:
        for message in messages(SHORT):
            is_motion = message.topic == '/pendulum/motion' and read_step_id(message.raw).step == 9
            yield message._replace(raw=message.raw[:-8] + bytes(8)) if is_motion else message

    bag = RunBag(write(tmp_path / 'run', [*messages(SHORT), *other()]))
    with pytest.raises(BagError, match='step 9 of pendulum/motion stands there twice with different content'):
        _ = bag.motion


def test_blocks_out_of_order_are_ordered_by_their_numbers(tmp_path: Path, right: Any) -> None:
    content = list(messages(SHORT))
    np.random.default_rng(1).shuffle(content)  # type: ignore[arg-type]
    bag = RunBag(write(tmp_path / 'run', [Message(*message)._replace(stamp=at) for at, message in enumerate(content)]))
    assert meaning(bag) == right
    assert bag.defects == ()


@pytest.mark.parametrize('storage', STORAGES)
@pytest.mark.parametrize('mode', [CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE])
@pytest.mark.parametrize('alone', [False, True])
def test_what_rosbag2_made_of_a_running_rig(
    tmp_path: Path, right: Any, storage: str, mode: CompressionMode, *, alone: bool
) -> None:
    bag = write(tmp_path / 'live', as_a_live_rig(SHORT), storage, mode)
    [file] = (path for path in bag.iterdir() if path.suffix != '.yaml')
    opened = RunBag(file if alone else bag)
    assert meaning(opened) == right
    assert (opened.first_stamp_ns, opened.last_stamp_ns) == (172_800_000_000_000, 172_807_600_000_000)
    assert opened.integrity.ok is None
    assert opened.foreign_topics == {'rosout_of_others'}
    if alone:
        (bag / 'metadata.yaml').unlink()
        assert meaning(RunBag(bag)) == right


@pytest.mark.parametrize('storage', STORAGES)
def test_files_that_were_split(tmp_path: Path, right: Any, storage: str) -> None:
    content = list(messages(SHORT))
    names = []
    bag = tmp_path / 'split'
    for part in range(11):  # so that 10 comes after 9
        piece = write(tmp_path / f'part_{part}', content[part * 45 : (part + 1) * 45], storage)
        [file] = (path for path in piece.iterdir() if path.suffix != '.yaml')
        bag.mkdir(exist_ok=True)
        names.append(f'split_{part}{file.suffix}')
        file.rename(bag / names[-1])
    assert meaning(RunBag(bag)) == right, 'without metadata'
    (tmp_path / 'part_0' / 'metadata.yaml').rename(bag / 'metadata.yaml')
    edit(bag, lambda said: said.update(relative_file_paths=names))
    assert meaning(RunBag(bag)) == right
    (bag / names[4]).unlink()
    opened = RunBag(bag)
    assert f'{names[4]}, named in metadata.yaml, is not there' in opened.defects
    assert any('of run 2: missing' in defect for defect in opened.defects)
    assert opened.motion.gaps == 1


@pytest.mark.parametrize('version', range(1, 10))
def test_metadata_of_all_versions_since_the_first(tmp_path: Path, right: Any, version: int) -> None:
    bag = write(tmp_path / 'old', messages(SHORT), 'sqlite3')

    def as_it_was(said: dict[str, Any]) -> None:
        said['version'] = version
        if version < 4:
            said['relative_file_paths'] = [f'old/{name}' for name in said['relative_file_paths']]
        dropped = {
            3: ('compression_format', 'compression_mode'),
            5: ('files',),
            6: ('custom_data',),
            8: ('ros_distro',),
        }
        for since, names in dropped.items():
            for name in names if version < since else ():
                said.pop(name, None)
        for topic in said['topics_with_message_count']:
            if version < 4:
                topic['topic_metadata'].pop('offered_qos_profiles')
            if version < 7:
                topic['topic_metadata'].pop('type_description_hash')
            elif version < 9:
                topic['topic_metadata']['offered_qos_profiles'] = '- history: 3\\n  depth: 0'

    edit(bag, as_it_was)
    assert meaning(RunBag(bag)) == right
    assert RunBag(bag).defects == ()


def test_a_database_of_the_first_layout(tmp_path: Path, right: Any) -> None:
    """Foxy's: no schema, no QoS, no message definitions."""
    base = sqlite3.connect(tmp_path / 'foxy_0.db3')
    base.execute('CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, '
                 'serialization_format TEXT NOT NULL)')  # fmt: skip
    base.execute('CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, '
                 'timestamp INTEGER NOT NULL, data BLOB NOT NULL)')  # fmt: skip
    numbers: dict[str, int] = {}
    for message in messages(SHORT):
        if message.topic not in numbers:
            numbers[message.topic] = len(numbers) + 1
            base.execute("INSERT INTO topics VALUES(?, ?, ?, 'cdr')", (len(numbers), message.topic, message.type))
        row = (numbers[message.topic], message.stamp, message.raw)
        base.execute('INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)', row)
    base.commit()
    base.close()
    assert meaning(RunBag(tmp_path / 'foxy_0.db3')) == right


@pytest.mark.parametrize('form', ['lz4', 'zstd', 'no chunks', 'no index', 'not closed'])
def test_files_of_the_mcap_package(tmp_path: Path, right: Any, form: str) -> None:
    path = tmp_path / 'run.mcap'
    kind = {'lz4': CompressionType.LZ4, 'zstd': CompressionType.ZSTD}.get(form, CompressionType.NONE)
    with path.open('wb') as file:
        bare = form == 'no index'
        writer = McapWriter(
            file, 50_000, kind, use_chunking=form != 'no chunks', use_statistics=not bare, use_summary_offsets=not bare
        )
        writer.start('ros2', 'test')
        channels: dict[str, int] = {}
        for message in messages(SHORT):
            if message.topic not in channels:
                schema = writer.register_schema(message.type, 'ros2msg', b'')
                channels[message.topic] = writer.register_channel(message.topic, 'cdr', schema)
            writer.add_message(channels[message.topic], message.stamp, message.raw, message.stamp)
        if form != 'not closed':
            writer.finish()
    opened = RunBag(path)
    if form == 'not closed':
        assert not opened.finished
        assert opened.steps > 70, 'of 76: the last chunk was never written'
        assert opened.complete is False
    else:
        assert meaning(opened) == right
        assert opened.defects == ()


def test_a_file_that_was_compressed_and_cut_short(tmp_path: Path) -> None:
    raw = next(SHORT.glob('*.mcap')).read_bytes()
    (tmp_path / 'run.mcap.zstd').write_bytes(zstandard.compress(raw)[: len(raw) // 2])
    opened = RunBag(tmp_path / 'run.mcap.zstd')
    assert 10 < opened.steps < 76
    assert opened.defects


@pytest.mark.parametrize('storage', STORAGES)
def test_metadata_that_promises_more_than_there_is(tmp_path: Path, storage: str) -> None:
    content = [message for message in messages(SHORT) if message.topic != '/jigsaw/pivot'][:-40]
    bag = write(tmp_path / 'run', content, storage)
    edit(bag, lambda said: [topic.update(message_count=77) for topic in said['topics_with_message_count']])
    opened = RunBag(bag)
    [promise] = (defect for defect in opened.defects if defect.startswith('metadata.yaml counts'))
    assert 'pendulum/motion' in promise
    assert '`kapitsa bag recover`' in promise


def test_a_recording_that_began_late_says_so(tmp_path: Path) -> None:
    settings = [message for message in messages(SHORT) if message.topic.endswith('settings')]
    later = [m for m in messages(SHORT) if not m.topic.endswith('settings') and read_step_id(m.raw).step >= 20]
    opened = RunBag(write(tmp_path / 'run', [*settings, *later]))
    assert opened.defects == ('steps 0 to 19 of run 2: missing',)
    assert (opened.motion.gaps, opened.motion.lost) == (1, pytest.approx(2.0))


def test_topics_that_nobody_recorded_are_named_and_make_no_run_whole(tmp_path: Path) -> None:
    """`ros2 bag record` takes the topics that it is told: what is not there is not called identical either."""
    some = write(tmp_path / 'some', (each for each in messages(SHORT) if each.topic != '/pendulum/motion'))
    bag = RunBag(some)
    assert bag.run.timings == RunBag(SHORT).run.timings
    assert bag.defects == ('run 2 has no message on pendulum/motion',)
    said = CliRunner().invoke(bag_command, ['info', str(some)])
    assert 'nothing of pendulum/motion was recorded' in ' '.join(said.stdout.split())
    assert 'The run is whole' not in said.stdout
    with pytest.raises(BagError, match='no message on pendulum/motion: what is not there cannot be compared'):
        verify_run(bag)
    with pytest.raises(BagError, match='has no motion that could be written'):
        export(bag, 'joint-states', tmp_path / 'joints')
    assert not (tmp_path / 'joints').exists()


def test_a_topic_that_was_taken_out_of_a_bag_with_digests_is_named(tmp_path: Path) -> None:
    made_up = made_up_run(tmp_path / 'run')
    rest = write(tmp_path / 'rest', (each for each in messages(made_up) if each.topic != '/pendulum/motion'))
    with pytest.raises(BagError, match=r'no step of a run: steps 0 to 12 of run 1 are damaged \(pendulum/motion\)'):
        _ = RunBag(rest).run


@pytest.mark.parametrize('storage', STORAGES)
@pytest.mark.parametrize('left_out', [(), ('digest',), ('last_group',)])
def test_digests_that_were_taken_out_are_missed(tmp_path: Path, storage: str, left_out: tuple[str, ...]) -> None:
    """With them went what tells that settings are others, and the bag said that its bytes were those recorded."""
    run = made_up_run(tmp_path / 'run')
    others = encode_settings('{"swings": 4}')

    def altered() -> Iterator[Message]:
        for each in messages(run):
            if each.topic != '/recorder/digest':
                yield each._replace(raw=others) if each.topic == '/stopwatch/settings' else each

    told = yaml.safe_load((run / 'metadata.yaml').read_text())['rosbag2_bagfile_information']['custom_data']
    rest = write(tmp_path / 'rest', altered(), storage)
    edit(rest, lambda information: information.update(custom_data={key: told[key] for key in told.keys() - left_out}))
    bag = RunBag(rest)
    assert bag.integrity.ok is False
    if left_out == ('digest',):
        with pytest.raises(BagError, match='not those whose digest its metadata states: files were exchanged'):
            bag.refuse_changed()
    else:
        [defect] = bag.defects
        assert defect.startswith('the digests of the steps of run 1 were taken out, though its metadata state them')


@pytest.mark.parametrize('storage', STORAGES)
def test_a_rig_in_a_namespace_is_the_rig_that_it_is(tmp_path: Path, storage: str) -> None:
    """`ros2 bag record -a` beside it writes the whole names."""
    run = made_up_run(tmp_path / 'run')

    def within(*namespaces: str) -> Iterator[Message]:
        yield Message('/rosout_of_others', 'std_msgs/msg/String', 1, encode_settings('hello'))
        for namespace in namespaces:
            yield from (each._replace(topic=f'{namespace}{each.topic}') for each in messages(run))

    recorded = write(tmp_path / 'lab', within('/lab/left'), storage)
    assert meaning(RunBag(recorded)) == meaning(RunBag(run))
    assert (RunBag(recorded).integrity.ok, RunBag(recorded).defects) == (True, ())
    assert (read_motion(recorded).angle == RunBag(run).motion.angle).all()
    with pytest.raises(BagError, match='holds the rigs of /left, /right: record, or convert'):
        RunBag(write(tmp_path / 'both', within('/left', '/right'), storage))
