"""Recorded runs computed again: identical, or the first difference is named."""

import json
import struct
from collections.abc import Callable, Iterable
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from rosbags.rosbag2 import Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from kapitsa_ros.cli.commands.verify import verify
from kapitsa_ros.laboratory.verification import verify_run
from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.registry import MOTION, REPLAYED, STOPWATCH_READING
from kapitsa_ros.network.settings import decode_settings, encode_settings
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.processor import parse_processor, processor, processor_text
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.recording.writer import RunWriter
from kapitsa_ros.versions import versions

SHIPPED = Path(__file__).parents[2] / 'bags'
STORE = get_typestore(Stores.ROS2_JAZZY)
DIGESTS = {
    'run_01_2240rpm': '61c74effe63c2e12864d7078d737a446a2fb5f6693c13745343228fcf6d8b408',
    'run_02_2640rpm': '4c80cba47e51f178996bd25e3b4d9d8d03706f329d9375d0a72815363ee39507',
    'run_03_2780rpm': '0ddf1b847b715b744cbd6eba706c9da5c55a4806f2e09841f4872d639bb47e94',
}
"""Of the shipped runs, for good."""


def altered(path: Path, change: Callable[[str, bytes], bytes]) -> RunBag:
    """Return a copy of a shipped run whose messages have been changed."""
    with (
        Reader(SHIPPED / 'run_02_2640rpm') as reader,
        Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer,
    ):
        links: dict[str, Any] = {}
        for link, stamp, raw in reader.messages():
            if link.topic not in links:
                links[link.topic] = writer.add_connection(link.topic, link.msgtype, typestore=STORE)
            writer.write(links[link.topic], stamp, change(link.topic, bytes(raw)))
    return RunBag(path)


@pytest.mark.parametrize('name', DIGESTS)
def test_the_shipped_runs_are_identical(name: str) -> None:
    bag = RunBag(SHIPPED / name)
    found = verify_run(bag)
    assert found.identical
    assert found.digest == bag.digest == DIGESTS[name]


def test_a_reading_altered_by_its_last_digit_is_named(tmp_path: Path) -> None:
    def change(topic: str, raw: bytes) -> bytes:
        """Change the last bit of what the display shows."""
        if topic != '/stopwatch/reading' or b'timed' not in raw:
            return raw
        at = STOPWATCH_READING.decode(raw).displayed
        stamp = struct.pack('<iI', *divmod(round(at * SECOND), SECOND))
        assert raw.count(stamp) == 1
        place = raw.index(stamp) + 4
        return raw[:place] + bytes([raw[place] ^ 1]) + raw[place + 1 :]

    bag = altered(tmp_path / 'run', change)
    found = verify_run(bag)
    assert not found.identical
    assert found.first_difference is not None
    assert (found.first_difference.topic, found.first_difference.field) == ('stopwatch/reading', 'displayed')
    assert found.first_difference.recorded == pytest.approx(found.first_difference.recomputed, abs=2e-9)


def test_a_byte_of_motion_flipped_is_named_with_its_step_and_sample(tmp_path: Path) -> None:
    at_step, sample = 60, 17
    originals: Iterable[float] = RunBag(SHIPPED / 'run_02_2640rpm').motion.angle

    def change(topic: str, raw: bytes) -> bytes:
        if topic != '/pendulum/motion' or read_step_id(raw).step != at_step or read_step_id(raw).end:
            return raw
        value = struct.pack('<d', originals[at_step * 100 + sample])
        at = raw.index(value)
        return raw[:at] + bytes([raw[at] ^ 1]) + raw[at + 1 :]

    found = verify_run(altered(tmp_path / 'run', change))
    first = found.first_difference
    assert first is not None
    assert (first.topic, first.run, first.step, first.field) == ('pendulum/motion', 2, at_step, f'position[{sample}]')
    assert found.largest_ulp == 1
    assert first.recorded != first.recomputed == originals[at_step * 100 + sample]


@pytest.mark.parametrize(
    ('role', 'name', 'value', 'topic'),
    [('pendulum', 'plant', {'damping': 0.0500001}, 'pendulum/motion'), ('stopwatch', 'seed', 7, 'stopwatch/reading')],
)
def test_other_settings_are_noticed_where_they_act(
    tmp_path: Path, role: str, name: str, value: Any, topic: str
) -> None:
    def change(of: str, raw: bytes) -> bytes:
        if of != f'/{role}/settings':
            return raw
        settings = json.loads(decode_settings(raw))
        settings[name] = settings[name] | value if isinstance(value, dict) else value
        return encode_settings(json.dumps(settings))

    first = verify_run(altered(tmp_path / 'run', change)).first_difference
    assert first is not None
    assert first.topic == topic


def test_settings_of_another_version_are_refused_by_name(tmp_path: Path) -> None:
    def change(of: str, raw: bytes) -> bytes:
        if of != '/strobe/settings':
            return raw
        return encode_settings(json.dumps(json.loads(decode_settings(raw)) | {'shutter': 1.0}))

    with pytest.raises(BagError, match='the settings of strobe hold shutter, which this version does not know'):
        verify_run(altered(tmp_path / 'run', change))


def test_a_digest_alone() -> None:
    bag = SHIPPED / 'run_02_2640rpm'
    same = CliRunner().invoke(verify, [str(bag), '--digest', DIGESTS['run_02_2640rpm'].upper(), '--json'])
    [told] = json.loads(same.stdout)['bags']
    assert same.exit_code == 0
    assert told['identical']
    assert told['first_difference'] is None
    other = CliRunner().invoke(verify, [str(bag), '--digest', DIGESTS['run_01_2240rpm']])
    assert other.exit_code == 1
    assert f'but the digest is {DIGESTS["run_02_2640rpm"]}' in other.stdout


def recorded_elsewhere(path: Path, processor: str, *, bend: bool) -> Path:
    """Return a shipped run as another machine might have recorded it, one sample with another last bit or not.

    The versions are those of here.
    """
    shipped = RunBag(SHIPPED / 'run_02_2640rpm')
    settings = dict(shipped.settings_texts)
    settings['jigsaw'] = json.dumps(json.loads(settings['jigsaw']) | {'versions': versions()})
    writer = RunWriter(path, 'mcap', settings, 5, processor=processor)
    names = [topic.name for topic in REPLAYED]
    for step_id, step in groupby(shipped.raw(*names), key=lambda message: read_step_id(message[2])):
        found = list(step)
        messages = {topic: raw for topic, _, raw in found}
        if bend and step_id.step == 7:
            raw = messages[MOTION.name]
            messages[MOTION.name] = raw[:-108] + bytes([raw[-108] ^ 2]) + raw[-107:]  # the last angle but one
        writer.write_step(found[0][1], messages)
    writer.close(complete=True)
    return path


def test_the_answer_tells_the_processor_it_was_recorded_on(tmp_path: Path, kapitsa: Callable[..., Any]) -> None:
    (tmp_path / 'runs').mkdir()
    for name, text in (('here', processor_text()), ('elsewhere', '["x86_64", "Z80"]'), ('unknown', '')):
        recorded_elsewhere(tmp_path / 'runs' / name, text, bend=True)
    recorded_elsewhere(tmp_path / 'runs' / 'same', '["x86_64", "Z80"]', bend=False)
    answer, said = (kapitsa('verify', tmp_path / 'runs', *how).out for how in (['--json'], []))
    values = {Path(each['bag']).name: each for each in json.loads(answer)['bags']}
    lines = {Path(line.split(',')[0]).name: line for line in said.splitlines()}
    here = list(processor())
    assert values['here']['other_processor'] is None
    assert values['elsewhere']['other_processor'] == {'recorded': ['x86_64', 'Z80'], 'here': here}
    assert values['unknown']['other_processor'] == {'recorded': None, 'here': here}
    assert values['same']['identical']
    for name in ('here', 'elsewhere', 'unknown'):
        assert (values[name]['identical'], values[name]['largest_ulp']) == (False, 2)
        assert values[name]['first_difference']['step'] == 7
        assert 'largest difference 2 ULP' in lines[name]
    assert 'identical, digest' in lines['same']
    assert 'recorded with a processor with Z80, here a processor with' in lines['elsewhere']
    assert 'a processor that the bag does not tell, here a processor with' in lines['unknown']


def test_a_setting_of_numba_by_which_the_last_digits_are_others_is_named(
    tmp_path: Path, kapitsa: Callable[..., Any]
) -> None:
    """And no change: nothing was altered but the setting."""
    bag = recorded_elsewhere(tmp_path / 'here', processor_text(), bend=True)
    answer = kapitsa('verify', bag, env={'NUMBA_DISABLE_JIT': '1'})
    assert answer.status == 1
    assert "recorded with NUMBA_DISABLE_JIT unset, here '1': a change is only what differs" in answer.out
    assert 'something was changed' in kapitsa('verify', bag, env={'NUMBA_DISABLE_JIT': '0'}).out


def test_settings_that_are_as_without_them_are_none(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = processor_text()
    monkeypatch.setenv('NUMBA_DISABLE_JIT', '0')
    monkeypatch.setenv('NUMBA_OPT', '3')
    assert processor_text() == plain
    monkeypatch.setenv('NUMBA_OPT', '0')
    assert parse_processor(processor_text()) == (*json.loads(plain), 'NUMBA_OPT=0')


@pytest.mark.parametrize('text', [None, '', '7', '{}', '[7]', '["a\\nb"]', '[' * 100_000])
def test_what_is_no_processor_is_none(text: str | None) -> None:
    assert parse_processor(text) is None
    assert parse_processor(processor_text()) == processor()
