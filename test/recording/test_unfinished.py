"""Bags whose recorder was killed: what was given to the disk is read, its loss is said, and it becomes a whole bag."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from bag_of_a_made_up_run import CLOCK, SETTINGS, step_messages, write
from rosbags.rosbag2 import Reader

from kapitsa_ros.network import registry
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.naming import run_folders
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.recording.recover import recover
from kapitsa_ros.recording.storage import mcap_file
from kapitsa_ros.recording.writer import RunWriter

STORAGES = ['mcap', 'sqlite3']


def killed(path: Path, storage: str, *, steps: int = 13, end: bool = False) -> Path:
    """Let a recorder be killed after so many steps."""
    script = (
        'import os, signal, sys; sys.path.insert(0, sys.argv[1]); from pathlib import Path\n'
        'import bag_of_a_made_up_run as made\n'
        'path, storage, steps, end = Path(sys.argv[2]), sys.argv[3], int(sys.argv[4]), sys.argv[5] == "True"\n'
        'writer = made.RunWriter(path, storage, made.SETTINGS, 5)\n'
        'ids = [made.StepId(1, step) for step in range(steps)] + [made.StepId(1, steps, end=True)] * end\n'
        'for step_id in ids:\n'
        '    writer.write_step(made.CLOCK.start_ns(step_id), made.step_messages(step_id))\n'
        'os.kill(os.getpid(), signal.SIGKILL)'
    )
    command = [sys.executable, '-c', script, str(Path(__file__).parent), str(path), storage, str(steps), str(end)]
    assert subprocess.run(command, check=False).returncode == -signal.SIGKILL
    return path


@pytest.mark.parametrize('storage', STORAGES)
def test_a_kill_costs_half_a_second_at_most_and_the_rest_is_read(tmp_path: Path, storage: str) -> None:
    bag = RunBag(killed(tmp_path / 'run', storage))
    assert bag.steps == 10, 'of 13'
    assert bag.integrity.ok
    assert not bag.complete
    assert bag.motion.angle.size == 1001
    assert bag.run.period == 0.5
    assert bag.defects[-2:] == (
        'it has no metadata.yaml: it was never finished, or is part of a bag',
        'run 1 has no end: it was interrupted, or what came after step 9 is lost',
    )


@pytest.mark.parametrize('storage', STORAGES)
def test_long_steps_are_not_kept_back_longer(tmp_path: Path, storage: str) -> None:
    """Steps of 0.25 s: two of them are half a second, whatever `steps_a_chunk` says."""
    writer = RunWriter(tmp_path / 'run', storage, SETTINGS, steps_a_chunk=1000)
    for step in range(9):
        writer.write_step(StepId(1, step).run + step * 250_000_000, step_messages(StepId(1, step)))
    bag = RunBag(tmp_path / 'run')  # as somebody would find it if the recorder were killed now
    assert bag.steps >= 8
    writer.abort()


@pytest.mark.parametrize('storage', STORAGES)
def test_what_was_given_to_the_disk_is_put_on_it_once_a_second(
    tmp_path: Path, storage: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    now, synced = 0.0, []
    wait = os.fdatasync
    monkeypatch.setattr(os, 'fdatasync', lambda descriptor: (synced.append(now), wait(descriptor)))
    writer = RunWriter(tmp_path / 'run', storage, SETTINGS, steps_a_chunk=5, clock=lambda: now)
    for step in range(100):  # 10 s simulated in 5 s of wall time
        now = step * 0.05
        writer.write_step(CLOCK.start_ns(StepId(1, step)), step_messages(StepId(1, step)))
        writer.sync()
    assert len(synced) == 4
    assert all(1.0 <= later - earlier <= 1.25 + 1e-9 for earlier, later in pairwise([0.0, *synced]))
    now = 60.0
    writer.sync()  # the rig stands still: what was written before goes on disk all the same
    assert len(synced) == 5
    writer.sync()
    assert len(synced) == 5, 'nothing is left to be put there'
    writer.abort()


@pytest.mark.parametrize('storage', STORAGES)
@pytest.mark.parametrize(('steps', 'end'), [(12, False), (14, True)])
def test_a_killed_bag_becomes_a_whole_one_in_its_place(tmp_path: Path, storage: str, steps: int, *, end: bool) -> None:
    path = killed(tmp_path / 'run', storage, steps=steps, end=end)
    before = RunBag(path)
    messages = list(before.raw(*(topic.name for topic in registry.RECORDED)))
    [made] = recover(path)
    assert made.bag == path
    assert made.steps == before.steps
    assert made.lost == 0.0
    assert made.reason == (
        'it came to its end' if before.complete else
        'the recorder was killed, or the machine stopped, before it could write metadata.yaml'
    )  # fmt: skip
    after = RunBag(path)
    assert after.integrity.ok
    assert after.complete == before.complete == end
    assert list(after.raw(*(topic.name for topic in registry.RECORDED))) == messages
    assert after.settings_texts == SETTINGS
    with Reader(path) as reader:  # any reader of rosbag2's bags takes it now
        assert reader.message_count == len(messages) + len(SETTINGS) + (steps + end) // 5, 'a digest for five steps'
    assert sorted(tmp_path.iterdir()) == [path], 'nothing is left beside it'
    assert len(list(path.iterdir())) == 2, 'metadata and the file'
    assert recover(path)[0].steps == made.steps, 'a whole bag stays as it is'


def unfinished(path: Path) -> Path:
    """Return a bag whose metadata were never written."""
    (write(path, end=False) / 'metadata.yaml').unlink()
    return path


def test_a_bag_that_is_larger_than_what_is_kept_of_it_is_recovered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is said of it is read of the old one, before it makes room."""
    monkeypatch.setattr(mcap_file, '_KEPT', 0)
    path = unfinished(tmp_path / 'run').rename(tmp_path / 'renamed')
    [made] = recover(path)
    assert (made.steps, made.lost) == (12, 0.0)
    assert RunBag(path).integrity.ok


def test_a_link_to_a_bag_stays_one_and_the_folder_one_is_in_has_a_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, link = unfinished(tmp_path / 'real' / 'run'), tmp_path / 'link'
    link.symlink_to(real)
    assert [made.bag for made in recover(link)] == [link]
    assert link.is_symlink()
    assert (RunBag(link).name, RunBag(real).is_whole) == ('link', True)
    monkeypatch.chdir(unfinished(tmp_path / 'real' / 'other'))
    assert RunBag('.').name == 'other'
    [made] = recover(Path(), tmp_path / 'new')
    assert made.bag == tmp_path / 'new' / 'other'
    [made] = recover(Path())
    assert made.steps == 12
    assert RunBag(tmp_path / 'real' / 'other').is_whole
    assert sorted(each.name for each in real.parent.iterdir()) == ['other', 'run']


def test_the_old_bag_is_back_where_the_new_one_cannot_take_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = unfinished(tmp_path / 'run')
    content = {each.name: each.read_bytes() for each in path.iterdir()}
    rename = Path.rename

    def interrupted(source: Path, target: Path) -> Path:
        if target == path and not source.name.endswith('.old'):
            raise KeyboardInterrupt
        return rename(source, target)

    monkeypatch.setattr(Path, 'rename', interrupted)
    with pytest.raises(KeyboardInterrupt):
        recover(path)
    assert {each.name: each.read_bytes() for each in path.iterdir()} == content
    assert list(tmp_path.iterdir()) == [path]


def test_a_bag_under_way_is_not_recovered_but_can_be_looked_into(tmp_path: Path) -> None:
    writer = RunWriter(tmp_path / 'run', 'mcap', SETTINGS, steps_a_chunk=5)
    for step in range(6):
        writer.write_step(CLOCK.start_ns(StepId(1, step)), step_messages(StepId(1, step)))
    assert RunBag(tmp_path / 'run').steps == 5
    with pytest.raises(BagError, match='is being recorded: end the run first'):
        recover(tmp_path / 'run')
    writer.close(complete=False)
    assert RunBag(tmp_path / 'run').steps == 6


def test_what_one_bag_cannot_take_over_stays_where_it_is(tmp_path: Path) -> None:
    path = write(tmp_path / 'run')
    file = path / 'run_0.mcap'
    raw = bytearray(file.read_bytes())
    raw[len(raw) // 3] ^= 1
    file.write_bytes(bytes(raw))
    (path / 'metadata.yaml').unlink()
    with pytest.raises(BagError, match=r'holds more than one whole bag can take over: .*; give --output'):
        recover(path)
    assert file.read_bytes() == raw
    [made] = recover(path, tmp_path / 'made')
    assert made.bag == tmp_path / 'made' / 'run'
    assert any('are damaged' in defect for defect in made.defects)
    assert RunBag(made.bag).steps == RunBag(path).steps


def test_metadata_that_was_lost_is_made_again(tmp_path: Path) -> None:
    path = write(tmp_path / 'run')
    before = (path / 'metadata.yaml').read_bytes()
    (path / 'metadata.yaml').unlink()
    [made] = recover(path)
    assert (made.steps, made.reason, made.defects) == (12, 'it came to its end', ())
    assert (path / 'metadata.yaml').read_bytes() == before


@pytest.mark.parametrize('storage', STORAGES)
def test_folders_of_runs_hold_unfinished_ones_too(tmp_path: Path, storage: str) -> None:
    runs = (write(tmp_path / 'run_01'), killed(tmp_path / 'run_02', storage))
    assert run_folders([tmp_path]) == runs


def test_commands_open_what_was_never_finished_and_say_so(tmp_path: Path, kapitsa: Callable[..., Any]) -> None:
    def told(*arguments: object) -> tuple[dict[str, Any], str]:
        answer = kapitsa(*arguments, '--json')
        return answer.json, answer.err

    shipped = Path(__file__).parents[2] / 'bags' / 'run_01_2240rpm'
    path = tmp_path / 'run'
    path.mkdir()
    raw = (shipped / 'run_01_2240rpm.mcap').read_bytes()
    (path / 'run_0.mcap').write_bytes(raw[: len(raw) * 19 // 20])
    info, said = told('bag', 'info', path)
    assert not info['complete']
    assert info['digest_ok'] is None
    assert info['messages'] < 939
    assert 'kapitsa: warning: ' in said
    assert 'ends in the middle of a record' in said
    assert 'it was never finished' in said
    analysed, said = told('analyse', path)
    [before] = analysed['runs']
    assert before['speed_reading_rpm'] == 2240.0
    assert before['samples'] > 14000
    assert before['defects'] == info['defects']
    assert 'has no end' in said
    recovered, _ = told('bag', 'recover', path)
    assert recovered['recovered'][0]['steps'] == pytest.approx(info['messages'] / 6, abs=2)
    assert told('bag', 'info', path)[0]['digest_ok'] is True
    [after] = told('analyse', path)[0]['runs']
    assert (after['samples'], after['gaps']) == (before['samples'], 0)
