"""Bags that know nothing of this package: one joint, stamps of wall time, jitter, drops, repetitions."""

import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.slow_frequency import DEFAULT_ESTIMATOR, ESTIMATORS
from kapitsa_ros.analysis.slow_frequency.estimate import SwingRecord
from kapitsa_ros.analysis.uneven_series import even_series
from kapitsa_ros.cli.commands.analyse import analyse
from kapitsa_ros.laboratory.joint_analysis import analyse_joints
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.joint_samples import joint_names, read_joint
from kapitsa_ros.units import RPM

STORE = get_typestore(Stores.ROS2_JAZZY)
SPEED = 2500 * RPM
SLOW = 2 * np.pi / 0.8
"""rad/s of the swing that is written."""
WALL = 1_760_000_000_000_000_000


def theta(time: Any) -> Any:
    """Return a slow swing, so small that it does not soften, with the ripple of the shaft on it."""
    slow = 0.01 * np.cos(SLOW * time)
    return slow * (1 + 0.05 * np.cos(SPEED * time))


def write(
    path: Path, time: Any, angle: Any, *, stamped: bool = True, velocity: bool = False, mixed: bool = False
) -> Path:
    kind = 'sensor_msgs/msg/JointState'
    types = STORE.types
    with Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        link = writer.add_connection('/arm/states', kind, typestore=STORE)
        for number, (seconds, value) in enumerate(zip(time, angle, strict=True)):
            stamp = WALL + round(seconds * 1e9)
            header = types['std_msgs/msg/Header'](
                types['builtin_interfaces/msg/Time'](*divmod(stamp if stamped else 0, 10**9)),
                'base' if not mixed or number % 2 else 'base of the arm',
            )
            rate = np.array([1.0, -SLOW * value]) if velocity else np.array([])
            message = types[kind](header, ['elbow', 'θ'], np.array([7.0, value]), rate, np.array([]))
            writer.write(link, stamp, STORE.serialize_cdr(message, kind))
    return path


def defects_and_slow(path: Path) -> tuple[list[str], float]:
    """Return what is said of a bag, and the slow frequency in it, swings a minute."""
    found = read_joint(path, 'θ')
    series = even_series((found.stamps_ns - WALL) / 1e9, found.position, found.rate, 0.25 * 2 * np.pi / SPEED)
    period = float(series.time[1])
    slow = ESTIMATORS[DEFAULT_ESTIMATOR](SwingRecord(angle=series.value, period=period, forcing=SPEED), 0.0)
    return [*found.defects, *series.defects], slow.value * 60 / (2 * np.pi)


EVEN = np.arange(0.0, 12.0, 0.001)


def test_an_even_recording_gives_the_frequency_and_nothing_to_say(tmp_path: Path) -> None:
    defects, slow = defects_and_slow(write(tmp_path / 'run', EVEN, theta(EVEN)))
    assert slow == pytest.approx(75.0, rel=1e-4)
    assert defects == []


def test_jitter_drops_and_repetitions_are_said_and_survived(tmp_path: Path) -> None:
    chance = np.random.default_rng(3)
    time = np.sort(EVEN + chance.normal(0.0, 5e-5, EVEN.size))
    kept = np.sort(np.concatenate((chance.permutation(time)[: int(0.99 * time.size)], time[100:110])))
    defects, slow = defects_and_slow(write(tmp_path / 'run', kept, theta(kept)))
    assert slow == pytest.approx(75.0, rel=1e-4)
    assert 'samples have the time of another' in ' '.join(defects)
    assert 'gaps, in which 0.1' in ' '.join(defects)
    assert 'times are uneven' in ' '.join(defects)


def test_a_wide_gap_ends_the_stretch_that_is_analysed(tmp_path: Path) -> None:
    time = EVEN[(EVEN < 3.0) | (EVEN > 4.0)]
    defects, slow = defects_and_slow(write(tmp_path / 'run', time, theta(time)))
    assert slow == pytest.approx(75.0, rel=1e-4)
    assert defects[0] == '1 gaps, in which 1.001 s are missing'
    assert '7.998 s of 12 s' in defects[1]


@pytest.mark.parametrize('mixed', [False, True])
def test_samples_are_those_that_were_written_to_the_last_bit(tmp_path: Path, *, mixed: bool) -> None:
    """Messages of one layout are read as a table, others one by one."""
    time = EVEN[:500]
    found = read_joint(write(tmp_path / 'run', time, theta(time), velocity=True, mixed=mixed), 'θ')
    assert found.position.tobytes() == theta(time).tobytes()
    assert found.rate is not None
    assert found.rate.tobytes() == (-SLOW * theta(time)).tobytes()
    assert (found.stamps_ns - WALL).tolist() == [round(each * 1e9) for each in time]


def test_headers_without_time_leave_the_time_of_recording(tmp_path: Path) -> None:
    found = read_joint(write(tmp_path / 'run', EVEN[:50], theta(EVEN[:50]), stamped=False), 'θ')
    assert (found.stamps_ns - WALL).tolist() == [round(each * 1e9) for each in EVEN[:50]]
    assert found.defects == ('the headers on arm/states carry no time: that of recording is taken',)


def test_a_joint_that_is_not_there_is_named_beside_those_that_are(tmp_path: Path) -> None:
    with pytest.raises(BagError, match='has no joint shoulder: elbow, θ'):
        read_joint(write(tmp_path / 'run', EVEN[:9], theta(EVEN[:9])), 'shoulder')


def write_joints(
    path: Path, samples: Iterable[tuple[str, float, list[str], list[float]]], *, little_endian: bool = True
) -> Path:
    """Write topic, time, joints and positions as they are."""
    kind, empty = 'sensor_msgs/msg/JointState', np.array([])
    types, links = STORE.types, {}
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for topic, seconds, joints, positions in samples:
            stamp = WALL + round(seconds * 1e9)
            time = types['builtin_interfaces/msg/Time'](*divmod(stamp, 10**9))
            message = types[kind](types['std_msgs/msg/Header'](time, 'base'), joints, np.array(positions), empty, empty)
            if topic not in links:
                links[topic] = writer.add_connection(topic, kind, typestore=STORE)
            writer.write(links[topic], stamp, STORE.serialize_cdr(message, kind, little_endian=little_endian))
    return path


FEW = [(float(time), float(theta(time))) for time in EVEN[:20]]


def test_the_order_of_bytes_is_that_which_a_message_states(tmp_path: Path) -> None:
    for little_endian in (True, False):
        samples = (('/arm', time, ['θ'], [angle]) for time, angle in FEW)
        found = read_joint(write_joints(tmp_path / f'{little_endian}', samples, little_endian=little_endian), 'θ')
        assert ((found.stamps_ns - WALL) / 1e9).tolist() == pytest.approx([time for time, _ in FEW], abs=1e-9)
        assert found.position.tolist() == [angle for _, angle in FEW]


def test_a_joint_that_not_every_message_names_is_found(tmp_path: Path) -> None:
    turns = ((('/arm', time, ['hand'], [0.0]), ('/arm', time, ['θ'], [angle])) for time, angle in FEW)
    bag = write_joints(tmp_path / 'run', (sample for both in turns for sample in both))
    found = read_joint(bag, 'θ')
    assert found.position.tolist() == [angle for _, angle in FEW]
    assert any('20 messages on arm are damaged or without θ' in defect for defect in found.defects)
    assert joint_names(bag) == ['hand', 'θ']


def test_of_a_joint_on_several_topics_that_of_one_can_be_named(tmp_path: Path) -> None:
    both = ((('/asked', time, ['θ'], [0.0]), ('/seen', time, ['θ'], [angle])) for time, angle in FEW)
    bag = write_joints(tmp_path / 'run', (sample for pair in both for sample in pair))
    with pytest.raises(BagError, match='has θ on asked, seen: name the joint as asked:θ or seen:θ'):
        read_joint(bag, 'θ')
    for name in ('seen:θ', '/seen:θ'):
        assert read_joint(bag, name).position.tolist() == [angle for _, angle in FEW]


def test_what_cannot_be_read_of_a_joint_is_said(tmp_path: Path) -> None:
    bag = write_joints(tmp_path / 'run', (('/arm', time, ['θ'], []) for time, _ in FEW))
    with pytest.raises(BagError, match='none of the 20 messages on arm has a position of θ'):
        read_joint(bag, 'θ')
    with pytest.raises(
        BagError, match='has no joint φ: none, as it has no sensor_msgs/msg/JointState but those of a rig'
    ):
        read_joint(write_joints(tmp_path / 'empty', []), 'φ')


def test_a_clock_that_was_set_back_does_not_mix_two_motions() -> None:
    again = np.concatenate((EVEN[:7000], EVEN[:5000] + 0.0005))
    value = np.concatenate((theta(EVEN[:7000]), theta(EVEN[7000:])))
    series = even_series(again, value, None, 0.006)
    assert series.value == pytest.approx(theta(EVEN[:7000]))
    [said] = series.defects
    assert said == 'the clock of the samples was set back 1 time: analysed is the longest part, 7000 of 12000 samples'
    late = np.arange(12000).reshape(-1, 2, 100)[:, ::-1].ravel()  # lots of a hundred, each other one late
    twice = np.concatenate((late, late))
    series = even_series(EVEN[twice], theta(EVEN)[twice], None, 0.006)
    assert series.value == pytest.approx(theta(EVEN))


@pytest.mark.parametrize(('factor', 'said'), [(0.0, 'by 0 times'), (180 / np.pi, 'by 0.0175'), (np.nan, 'not finite')])
def test_velocities_that_are_none_are_not_taken(factor: float, said: str) -> None:
    time = np.sort(EVEN + np.random.default_rng(1).uniform(-3e-4, 3e-4, EVEN.size))
    rate = np.gradient(theta(time), time)
    alone, *others = (even_series(time, theta(time), each, 0.006) for each in (None, factor * rate, rate))
    assert (others[0].value == alone.value).all()
    assert said in others[0].defects[-1]
    assert others[1].defects == alone.defects
    assert (others[1].value != alone.value).any()


def test_an_angle_that_is_not_counted_from_the_upright_is_named(tmp_path: Path) -> None:
    bag = write_joints(tmp_path / 'run', (('/arm', time, ['θ'], [angle + np.pi]) for time, angle in FEW))
    with pytest.raises(AnalysisError, match=r'θ stays between 3\.15 and 3\.15 rad and never passes 0, the upright'):
        analyse_joints([bag], 'θ', [SPEED], Plant())


def test_what_is_no_motion_is_refused() -> None:
    nothing = np.full(100, np.nan)
    with pytest.raises(AnalysisError, match='0 samples are no motion'):
        even_series(np.arange(100.0), nothing, None, 1.0)
    with pytest.raises(AnalysisError, match='all gaps'):
        even_series(np.repeat(np.arange(10.0) * 100, 2) + np.tile([0, 0.001], 10), np.zeros(20), None, 0.01)


def test_the_command_line(tmp_path: Path, kapitsa: Callable[..., Any]) -> None:
    bag = str(write(tmp_path / 'run', np.delete(EVEN, 3000), np.delete(theta(EVEN), 3000)))
    done = kapitsa('analyse', bag, '--joint', 'θ', '--speed', '2500', '--length', '0.3', '--json')
    values = done.json
    [run] = values['runs']
    assert run['slow_rpm'] == pytest.approx(75.0, rel=1e-4)
    assert (run['samples'], run['gaps'], run['digest_ok']) == (11999, 1, None)
    assert values['truth_rpm'] is None
    assert values['plant']['length'] == 0.3
    assert run['speed_taken_rpm'] == pytest.approx(2500.0)
    shown = CliRunner().invoke(analyse, [bag, '--joint', 'θ', '--speed', '2500', '--length', '0.3']).stdout
    assert re.search(r'│ +2500\.0│ +0\.800│ +75\.0│', re.sub(r' +│', '│', shown))
    assert 'periods are those of a small swing' in shown
    assert 'warning: ' in done.err
    assert '1 gaps, in which 0.001 s are missing' in done.err
    for wrong, words in (
        (['--joint', 'θ'], '--speed is needed with --joint'),
        (['--speed', '2500'], 'it is for --joint'),
        (['--joint', 'θ', '--speed', '0'], 'a speed of 0 RPM: the shaft has to turn'),
        (['--joint', 'θ', '--speed', '2500', '--table', 'x.csv'], 'a motion has no timings'),
    ):
        assert words in str(CliRunner().invoke(analyse, [bag, *wrong]).exception)
