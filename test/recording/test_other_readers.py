"""Readers that know nothing of this package decode its bags to the same numbers, and its layouts name what is there."""

import json
import os
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bag_of_a_made_up_run import write
from mcap.reader import make_reader

from kapitsa_ros.network.typestore import deserialise
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.export_files import export
from kapitsa_ros.recording.reader import RunBag, open_runs
from kapitsa_ros.recording.storage.mcap_file import McapFile

DecoderFactory = pytest.importorskip('mcap_ros2.decoder').DecoderFactory
ROOT = Path(__file__).parents[2]
VIEWERS = ROOT / 'config' / 'viewers'
SHIPPED = ROOT / 'bags' / 'run_02_2640rpm'


def storage_file(bag: Path) -> Path:
    [found] = bag.glob('*.mcap')
    return found


def decoded(file: Path) -> Iterator[tuple[str, int, Any]]:
    """Yield topic, stamp and message as mcap-ros2-support has them, from the definitions in the file alone."""
    with file.open('rb') as stream:
        for _, channel, message, content in make_reader(
            stream, decoder_factories=[DecoderFactory()]
        ).iter_decoded_messages():
            yield channel.topic, message.log_time, content


def same(ours: Any, theirs: Any) -> bool:
    """Whether two messages hold the same, field by field and bit by bit."""
    if is_dataclass(ours):
        names = [field.name for field in fields(ours) if not field.name.startswith('__') and not field.name.isupper()]
        return all(same(getattr(ours, name), getattr(theirs, name)) for name in names)
    if isinstance(ours, np.ndarray):
        return ours.tobytes() == np.array(theirs, ours.dtype).tobytes()
    if isinstance(ours, list):
        return len(ours) == len(theirs) and all(map(same, ours, theirs))
    return bool(ours == theirs)


@pytest.mark.parametrize('recorded', ['now', 'shipped'])
def test_every_message_of_every_topic_is_the_same(tmp_path: Path, recorded: str) -> None:
    bag = SHIPPED if recorded == 'shipped' else write(tmp_path / 'run')
    ours = sorted(McapFile(storage_file(bag)).scan(), key=lambda message: (message.topic, message.stamp_ns))
    theirs = sorted(decoded(storage_file(bag)), key=lambda message: message[:2])
    assert len(ours) == len(theirs)
    for message, (topic, stamp, content) in zip(ours, theirs, strict=True):
        assert (f'/{message.topic}', message.stamp_ns) == (f'/{topic.lstrip("/")}', stamp)
        assert same(deserialise(message.type, message.data), content)


@pytest.fixture(scope='module')
def joints(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, RunBag]:
    run = RunBag(SHIPPED)
    bag = tmp_path_factory.mktemp('exported') / 'joints'
    export(run, 'joint-states', bag)
    return bag, run


def test_a_bag_of_others_names_the_joint_that_can_be_analysed(joints: tuple[Path, RunBag]) -> None:
    with pytest.raises(BagError, match=r'; joint pendulum in it is analysed by `kapitsa analyse .* --joint NAME'):
        open_runs(joints[0])


def test_viewers_see_one_curve(joints: tuple[Path, RunBag]) -> None:
    """What the layouts plot of an exported bag is the motion, sample by sample, at its own stamps."""
    bag, run = joints
    messages = list(decoded(storage_file(bag)))
    assert {topic for topic, _, _ in messages} == {'/joint_states'}
    stamps = [content.header.stamp.sec * 10**9 + content.header.stamp.nanosec for _, _, content in messages]
    assert stamps == [stamp for _, stamp, _ in messages] == run.motion.stamps_ns.tolist()
    assert np.unique(np.diff(stamps)).tolist() == [10**6], '1 kHz'
    motion = {'position': run.motion.angle, 'velocity': run.motion.rate}
    layout = json.loads((VIEWERS / 'foxglove_joint_states.json').read_text(encoding='utf-8'))
    plotted = [path['value'] for panel in layout['configById'].values() for path in panel['paths']]
    for path in plotted:
        field, at = re.fullmatch(r'/joint_states\.(\w+)\[(\d)\]', path).groups()  # type: ignore[union-attr]
        curve = np.array([getattr(content, field)[int(at)] for _, _, content in messages])
        assert curve.tobytes() == motion.pop(field).tobytes()
    assert not motion, 'both are plotted'
    curves = {curve.attrib['name'] for curve in ET.parse(VIEWERS / 'plotjuggler.xml').iter('curve')}
    assert {f'/joint_states/{name}/position' for name in messages[0][2].name} <= curves


NODE = """
const { McapIndexedReader } = require('@mcap/core');
const { MessageReader } = require('@foxglove/rosmsg2-serialization');
const { parse } = require('@foxglove/rosmsg');
const { decompress } = require('fzstd');
const { readFileSync } = require('fs');
(async () => {
  const bytes = readFileSync(process.argv[1]);
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (at, size) => new Uint8Array(bytes.subarray(Number(at), Number(at + size))),
  };
  const decompressHandlers = { zstd: (data) => decompress(data) };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const readers = new Map();
  const text = new TextDecoder();
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    if (!readers.has(channel.id)) {
      const schema = reader.schemasById.get(channel.schemaId);
      readers.set(channel.id, new MessageReader(parse(text.decode(schema.data), { ros2: true })));
    }
    const content = readers.get(channel.id).readMessage(message.data);
    const motion = channel.topic.endsWith('pendulum/motion') ? content.points.map((point) => point.positions[0]) : [];
    const angle = channel.topic === '/joint_states' ? [content.position[0]] : motion;
    console.log(JSON.stringify([channel.topic, String(message.logTime), angle]));
  }
})();
"""


@pytest.mark.slow
def test_the_readers_of_foxglove_in_javascript(joints: tuple[Path, RunBag], tmp_path: Path) -> None:
    node = shutil.which('node')
    packages = '@mcap/core @foxglove/rosmsg @foxglove/rosmsg2-serialization fzstd'
    if (
        node is None
        or subprocess.run([node, '-e', "require('@mcap/core')"], capture_output=True, check=False).returncode
    ):
        pytest.skip(f'needs node and NODE_PATH to a folder with {packages}')
    for bag in (joints[0], write(tmp_path / 'run')):
        done = subprocess.run(
            [node, '-e', NODE, str(storage_file(bag))], capture_output=True, text=True, check=True, env=os.environ
        )
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        with storage_file(bag).open('rb') as stream:
            assert len(lines) == make_reader(stream).get_summary().statistics.message_count  # type: ignore[union-attr]
        angles = [value for _, _, values in lines for value in values]
        motion = joints[1].motion.angle if bag == joints[0] else None
        if motion is None:
            blocks = [message for message in McapFile(storage_file(bag)).scan() if message.topic == 'pendulum/motion']
            blocks.sort(key=lambda message: message.stamp_ns)
            points = [point for block in blocks for point in deserialise(block.type, block.data).points]
            motion = np.array([point.positions[0] for point in points])
        assert np.array(angles).tobytes() == motion.tobytes()
