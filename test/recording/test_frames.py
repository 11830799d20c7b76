"""A recorded run as objects of pandas and xarray: values to the bit, units, what is missing."""

from pathlib import Path

import numpy as np
import pytest
from bag_of_a_made_up_run import write

from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.motion import Motion
from kapitsa_ros.recording.reader import RunBag

pytest.importorskip('pandas')
pytest.importorskip('xarray')
SHIPPED = Path(__file__).parents[2] / 'bags' / 'run_02_2640rpm'


def test_a_run_as_a_data_frame() -> None:
    bag = RunBag(SHIPPED)
    frame = bag.to_pandas()
    assert frame.pendulum_angle_rad.dropna().to_numpy().tobytes() == bag.motion.angle.tobytes()
    assert frame.time_s.is_monotonic_increasing
    readings = bag.run.readings['stopwatch']
    assert frame.stopwatch_displayed_s.dropna().tolist() == [each.displayed for each in readings]
    assert frame.attrs['run'] == '2'
    assert frame.attrs['digest'] == bag.digest
    assert list(bag.to_pandas('strobe/reading').columns) == ['time_s', 'strobe_speed_rad_s']
    with pytest.raises(BagError, match='give one of'):
        bag.to_pandas('clock')


def test_a_run_as_a_dataset() -> None:
    bag = RunBag(SHIPPED)
    found = bag.to_xarray()
    angle = found.pendulum_angle_rad
    assert (angle.dims, angle.attrs['units']) == (('time_pendulum_motion',), 'rad')
    assert angle.to_numpy().tobytes() == bag.motion.angle.tobytes()
    assert found.time_pendulum_motion.attrs['units'] == 's'
    assert found.strobe_speed_rad_s.to_numpy().tolist() == [each.speed for each in bag.run.readings['strobe']]
    assert found.stopwatch_kind.to_numpy().tolist() == [each.kind for each in bag.run.readings['stopwatch']]
    assert found.pivot_acceleration_m_s2.attrs['units'] == 'm/s^2'
    assert found.attrs['digest'] == bag.digest


def test_a_motion_has_one_rate_and_no_gap() -> None:
    motion = RunBag(SHIPPED).motion
    assert motion.sample_rate == 1000.0
    found = motion.to_xarray()
    assert found.angle_rad.sel(time_s=1.0).item() == motion.angle[1000]
    assert found.rate_rad_s.attrs == {'units': 'rad/s'}
    assert found.attrs == motion.to_pandas().attrs == {'gaps': 0, 'lost_s': 0.0}


def test_a_motion_with_a_gap_or_uneven_stamps_has_no_rate(tmp_path: Path) -> None:
    motion = RunBag(write(tmp_path / 'run', leave_out=5)).motion
    with pytest.raises(BagError, match=r'0\.099 s of the motion are missing in 1 place'):
        _ = motion.sample_rate
    assert motion.to_pandas().attrs == motion.to_xarray().attrs == {'gaps': 1, 'lost_s': pytest.approx(0.099)}
    values = np.zeros(3)
    for stamps in ([0, 1, 3], [5], [0, 1, 1]):
        uneven = Motion(np.array(stamps), values[: len(stamps)], values[: len(stamps)], 0, 0.0)
        with pytest.raises(BagError, match='not equally far apart'):
            _ = uneven.sample_rate
