"""Names with line breaks in them, and rows whose numbers are none: what is said of a bag stays a line a defect."""

import json
import sqlite3
from pathlib import Path

import pytest
from bag_of_a_made_up_run import write
from numpy import array
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from kapitsa_ros.network.settings import encode_settings
from kapitsa_ros.recording.digest import DIGEST_TOPIC
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.joint_samples import read_joint
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.recording.sealed_motion import read_motion

STORE = get_typestore(Stores.ROS2_JAZZY)


def one_line_each(said: tuple[str, ...]) -> None:
    assert said
    for line in said:
        assert line.isprintable(), line


def test_topics_of_the_metadata(tmp_path: Path) -> None:
    bag = write(tmp_path / 'run')
    metadata = bag / 'metadata.yaml'
    metadata.write_text(metadata.read_text().replace('name: /pendulum/motion', 'name: "/pendulum/\\nTraceback\\e[2J"'))
    one_line_each(RunBag(bag).defects)


def test_topics_of_a_digest(tmp_path: Path) -> None:
    """Somebody's digest that names a topic which nobody recorded."""
    bag = write(tmp_path / 'run', storage='sqlite3')
    (bag / 'metadata.yaml').unlink()
    group = {'run': 1, 'first': 0, 'last': 4, 'end': False, 'topics': {'a\nb': '0'}, 'settings': {}, 'previous': ''}
    with sqlite3.connect(bag / 'run_0.db3') as base:
        [(topic,)] = base.execute('SELECT id FROM topics WHERE name=?', (f'/{DIGEST_TOPIC}',))
        [(first,)] = base.execute('SELECT min(id) FROM messages WHERE topic_id=?', (topic,))
        base.execute('UPDATE messages SET data=? WHERE id=?', (encode_settings(json.dumps(group)), first))
    base.close()
    one_line_each(RunBag(bag).defects)


def test_the_name_of_a_folder(tmp_path: Path) -> None:
    bag = write(tmp_path / 'run\n1', end=False)
    one_line_each(RunBag(bag).defects)
    file = bag / f'{bag.name}_0.mcap'
    for size in (100, 3000):
        file.write_bytes(file.read_bytes()[:size])
        with pytest.raises(BagError) as error:
            RunBag(bag)
        one_line_each((str(error.value),))


def test_topics_of_a_joint(tmp_path: Path) -> None:
    kind = 'sensor_msgs/msg/JointState'
    state, header, time = (STORE.types[name] for name in (kind, 'std_msgs/msg/Header', 'builtin_interfaces/msg/Time'))
    with Writer(tmp_path / 'bag', version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        link = writer.add_connection('/joint\nstates', kind, typestore=STORE)
        for number in range(5):
            message = state(header(time(0, 0), ''), ['arm'], array([0.1 * number]), array([]), array([]))
            writer.write(link, number, STORE.serialize_cdr(message, kind))
        writer.write(link, 5, b'\x00\x01\x00\x00')
    samples = read_joint(tmp_path / 'bag', 'arm')
    assert samples.position.tolist() == [0.0, 0.1, 0.2, 0.30000000000000004, 0.4]
    one_line_each(samples.defects)
    with pytest.raises(BagError) as error:
        read_joint(tmp_path / 'bag', 'leg\n2')
    one_line_each((str(error.value),))


@pytest.mark.parametrize('column', ['timestamp', 'topic_id', 'data'])
@pytest.mark.parametrize('value', [None, 'ten\nlines', 1.5, -1, 2**62, b'\xff'])
def test_a_row_whose_numbers_are_none(tmp_path: Path, column: str, value: object) -> None:
    """The stamp that a storage has for a message decides nothing; any other change is said, and its steps left out."""
    bag = write(tmp_path / 'run', storage='sqlite3')
    right = RunBag(bag).motion
    with sqlite3.connect(bag / 'run_0.db3') as base:
        base.execute('CREATE TABLE copy(id INTEGER PRIMARY KEY, topic_id, timestamp, data)')
        base.execute('INSERT INTO copy SELECT id, topic_id, timestamp, data FROM messages')
        base.execute('DROP TABLE messages')
        base.execute('ALTER TABLE copy RENAME TO messages')
        base.execute(f'UPDATE messages SET {column}=? WHERE id=20', (value,))  # noqa: S608
    base.close()
    opened = RunBag(bag)
    if column == 'timestamp' and isinstance(value, int):
        assert opened.defects == ()
        assert opened.motion.angle.tobytes() == right.angle.tobytes()
        return
    one_line_each(opened.defects)
    assert opened.integrity.ok is False
    assert opened.run.complete
    assert (opened.motion.lost, opened.motion.gaps) == (0.5, 1)
    assert read_motion(bag).angle.tobytes() == opened.motion.angle.tobytes()
    assert opened.motion.angle[1:].tobytes() == right.angle[501:].tobytes()
