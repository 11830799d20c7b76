"""Runs in other tools' formats: every number comes back, with its unit; nothing is overwritten."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from click.testing import CliRunner
from mcap.reader import make_reader
from pyarrow import parquet
from rosbags.rosbag2 import Reader
from scipy.io import netcdf_file

from kapitsa_ros.cli.commands.bag import bag as bag_command
from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.network.registry import PIVOT
from kapitsa_ros.recording.export_files import export
from kapitsa_ros.recording.joint_samples import read_joint
from kapitsa_ros.recording.reader import RunBag

SHIPPED = Path(__file__).parents[2] / 'bags' / 'run_02_2640rpm'
COLUMNS = [
    'time_s', 'pendulum_angle_rad', 'pendulum_rate_rad_s', 'pivot_m', 'pivot_rate_m_s', 'pivot_acceleration_m_s2',
    'command_speed_rad_s', 'command_hold_rad', 'strobe_speed_rad_s', 'stopwatch_displayed_s', 'stopwatch_swings',
    'stopwatch_kind',
]  # fmt: skip


@pytest.fixture(scope='module')
def run() -> RunBag:
    return RunBag(SHIPPED)


def check(frame: Any, run: RunBag) -> None:
    assert list(frame.columns) == COLUMNS
    moving = frame[frame.pendulum_angle_rad.notna()]
    assert moving.pendulum_angle_rad.to_numpy().tobytes() == run.motion.angle.tobytes()
    assert moving.pendulum_rate_rad_s.to_numpy().tobytes() == run.motion.rate.tobytes()
    assert moving.time_s.to_numpy() == pytest.approx((run.motion.stamps_ns - 172_800 * 10**9) / 1e9, abs=1e-12)
    pivot = np.concatenate([block.position[:-1] for _, block in run.pivot()])  # noqa: PD010 - no frame
    assert frame.pivot_m.dropna().to_numpy().tobytes() == pivot.tobytes()
    read = frame[frame.stopwatch_displayed_s.notna()]
    assert read.stopwatch_displayed_s.tolist() == [each.displayed for each in run.run.readings['stopwatch']]
    assert read.stopwatch_kind.tolist() == [each.kind for each in run.run.readings['stopwatch']]
    assert frame.strobe_speed_rad_s.dropna().tolist() == [each.speed for each in run.run.readings['strobe']]
    assert frame.command_speed_rad_s.dropna().size == 76


def test_csv(tmp_path: Path, run: RunBag) -> None:
    path = tmp_path / 'run.csv'
    assert export(run, 'csv', path) == 7603
    check(pd.read_csv(path, comment='#', float_precision='round_trip'), run)
    about = dict(line[2:].split(': ', 1) for line in path.read_text().splitlines() if line.startswith('# '))
    assert about['digest'] == run.digest
    assert json.loads(about['settings'])['jigsaw']['amplitude'] == 0.0127


def test_parquet(tmp_path: Path, run: RunBag) -> None:
    path = tmp_path / 'run.parquet'
    assert export(run, 'parquet', path) == 7603
    check(pd.read_parquet(path), run)
    assert json.loads(parquet.read_schema(path).metadata[b'settings'])['strobe']['seed'] == 1997


def test_netcdf(tmp_path: Path, run: RunBag) -> None:
    path = tmp_path / 'run.nc'
    export(run, 'netcdf', path)
    with netcdf_file(path, mmap=False) as file:
        angle = file.variables['pendulum_angle_rad']
        assert (angle.dimensions, angle.units) == (('time_pendulum_motion',), b'rad')
        assert np.array(angle[:], np.float64).tobytes() == run.motion.angle.tobytes()
        assert file.variables['pivot_acceleration_m_s2'].units == b'm/s^2'
        assert file.variables['time_pendulum_motion'].units == b's'
        assert file.variables['stopwatch_kind'][:].tobytes().decode().startswith('timed')
        assert json.loads(file.settings)['stopwatch']['swings'] == 3
    with xr.open_dataset(path, engine='scipy') as found:
        assert found.pendulum_angle_rad.to_numpy().tobytes() == run.motion.angle.tobytes()
        assert found.pendulum_angle_rad.attrs['units'] == 'rad'
        assert found.stopwatch_displayed_s.to_numpy().tolist() == [2.14]
        own = run.to_xarray()
        for name in own.data_vars:
            if name != 'stopwatch_kind':  # NetCDF has characters, not texts
                xr.testing.assert_equal(found[name], own[name])


def test_a_bag_for_viewers_has_one_sample_a_message(tmp_path: Path, run: RunBag) -> None:
    path = tmp_path / 'viewers'
    assert export(run, 'joint-states', path) == run.motion.angle.size
    found = read_joint(path, 'pendulum')
    assert found.position.tobytes() == run.motion.angle.tobytes()
    assert found.rate is not None
    assert found.rate.tobytes() == run.motion.rate.tobytes()
    assert (found.stamps_ns == run.motion.stamps_ns).all()
    with Reader(path) as reader:
        assert reader.message_count == run.motion.angle.size
    with next(path.glob('*.mcap')).open('rb') as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == run.motion.angle.size


def test_topics_are_chosen_and_nothing_is_overwritten(tmp_path: Path, run: RunBag) -> None:
    path = tmp_path / 'some.csv'
    export(run, 'csv', path, (f'/{PIVOT.name}',))
    assert list(pd.read_csv(path, comment='#').columns) == [
        name for name in COLUMNS if name.startswith(('time', 'pivot'))
    ]
    before = path.read_bytes()
    with pytest.raises(KapitsaError, match='--overwrite to replace it'):
        export(run, 'csv', path)
    with pytest.raises(KapitsaError, match='is there already and stays'):
        export(run, 'joint-states', path, overwrite=True)
    assert path.read_bytes() == before
    assert export(run, 'csv', path, overwrite=True)
    assert path.read_bytes() != before
    with pytest.raises(KapitsaError, match='give one of pendulum/motion, jigsaw/pivot'):
        export(run, 'csv', tmp_path / 'other.csv', ('clock',))
    assert not (tmp_path / 'other.csv').exists()
    with pytest.raises(KapitsaError, match='joint-states are the motion alone'):
        export(run, 'joint-states', tmp_path / 'joints', (PIVOT.name,))
    assert not (tmp_path / 'joints').exists()


def test_what_goes_to_a_pipe_is_the_table_alone(tmp_path: Path, kapitsa: Callable[..., Any]) -> None:
    """As to /dev/stdout, where another program reads it."""
    reader, writer = os.pipe()
    (tmp_path / 'stdout').symlink_to(f'/proc/{os.getpid()}/fd/{writer}')
    arguments = ['export', SHIPPED, '--format', 'csv', '--topic', 'strobe/reading', '--output', tmp_path / 'stdout']
    done = kapitsa('bag', *arguments)
    assert (done.status, done.out) == (0, '')
    assert done.err.endswith(' rows\n')
    os.close(writer)
    with os.fdopen(reader) as file:
        assert file.read().count('time_s') == 1


def test_the_command_line(tmp_path: Path) -> None:
    arguments = ['export', str(SHIPPED), '--format', 'csv', '--output', str(tmp_path / 'run.csv'), '--json']
    done = CliRunner().invoke(bag_command, arguments)
    assert json.loads(done.stdout) == {'output': str(tmp_path / 'run.csv'), 'rows': 7603}
