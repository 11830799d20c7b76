"""Files of exported runs: CSV, Parquet, NetCDF, and a bag with one sample of the motion a message."""

from __future__ import annotations

import csv
import shutil
from typing import TYPE_CHECKING, Any

import numpy as np
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.typesys import Stores, get_typestore
from scipy.io import netcdf_file

from kapitsa_ros.errors import OPTION, OutputError
from kapitsa_ros.extras import import_of_extra
from kapitsa_ros.network.registry import MOTION
from kapitsa_ros.network.typestore import new_message, new_time, serialise
from kapitsa_ros.output_file import check_output, replacing
from kapitsa_ros.recording.bag_writer import BagWriter
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.export import described, joined, tables, time_of, unit_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from kapitsa_ros.recording.export import Table
    from kapitsa_ros.recording.reader import RunBag

JOINT_STATES = 'joint-states'
_JOINT_STATE = 'sensor_msgs/msg/JointState'


def export(bag: RunBag, kind: str, output: Path, topics: tuple[str, ...] = (), *, overwrite: bool = False) -> int:
    """Write a run to a file, or its motion to a new bag; return the number of rows or messages.

    Parameters
    ----------
    bag
        The run.
    kind
        A name in `FORMATS`.
    output
        The file, or the folder of the bag.
    topics
        Names; all that can be had where none is given.
    overwrite
        A file that is there may be replaced; a folder never is.

    Raises
    ------
    OutputError
        Something is there already, it cannot be written, or topics are given for what has the motion alone.
    BagError
        The run cannot be read.
    MissingPackageError
        The format needs a package of the extra `report`.

    """
    if output.is_dir() or (kind == JOINT_STATES and output.exists()):
        raise OutputError(f'{OPTION}: is there already and stays; give another name', option='output', value=output)
    if kind == JOINT_STATES and topics and {topic.removeprefix('/') for topic in topics} != {MOTION.name}:
        raise OutputError(f'{OPTION}: joint-states are the motion alone; leave it out', option='topic', value=topics[0])
    check_output(output, overwrite=overwrite)
    if kind == JOINT_STATES:
        return _write_joint_states(bag, output)
    if kind == 'parquet':
        import_of_extra('pyarrow.parquet', 'Parquet', 'report')
    found, about = tables(bag, topics), described(bag)
    with replacing(output) as draft:
        return FORMATS[kind](draft, found, about)


def _write_csv(path: Path, found: tuple[Table, ...], about: Mapping[str, str]) -> int:
    columns = joined(found)
    texts = [
        [value or '' for value in values.tolist()]
        if values.dtype.kind == 'U'
        else ['' if np.isnan(value) else repr(value) for value in values.tolist()]
        for values in columns.values()
    ]
    with path.open('w', encoding='utf-8', newline='') as file:
        file.writelines(f'# {name}: {value}\n' for name, value in about.items())
        writer = csv.writer(file, lineterminator='\n')
        writer.writerow(columns)
        writer.writerows(zip(*texts, strict=True))
    return len(texts[0])


def _write_parquet(path: Path, found: tuple[Table, ...], about: Mapping[str, str]) -> int:
    table = import_of_extra('pyarrow', 'Parquet', 'report').table(joined(found)).replace_schema_metadata(dict(about))
    with path.open('wb') as file:  # a name has to be UTF-8 there, and may be taken for an address
        import_of_extra('pyarrow.parquet', 'Parquet', 'report').write_table(table, file)
    return int(table.num_rows)


def _write_netcdf(path: Path, found: tuple[Table, ...], about: Mapping[str, str]) -> int:
    """Write a dimension a topic: `time_pendulum_motion` and so on; NetCDF 3 knows no texts but rows of characters."""
    rows = 0
    with netcdf_file(path, 'w', version=2) as file:
        for name, value in about.items():
            setattr(file, name, value.encode())
        for table in found:
            dimension = time_of(table)
            rows += table.columns['time_s'].size
            file.createDimension(dimension, table.columns['time_s'].size)
            for name, values in table.columns.items():
                _put(file, dimension if name == 'time_s' else name, dimension, values, unit=unit_of(name))
    return rows


def _put(file: Any, name: str, dimension: str, values: Any, *, unit: str) -> None:
    if values.dtype.kind == 'U':
        texts = np.char.encode(values, 'ascii')
        length = f'{name}_length'
        file.createDimension(length, max(texts.dtype.itemsize, 1))
        variable = file.createVariable(name, 'c', (dimension, length))
        variable[:] = texts.astype(f'S{max(texts.dtype.itemsize, 1)}').view('S1').reshape(values.size, -1)
    else:
        variable = file.createVariable(name, 'd', (dimension,))
        variable[:] = values
        variable.units = unit.encode()


def _write_joint_states(bag: RunBag, path: Path) -> int:
    motion = bag.motion
    if not motion.angle.size:
        raise BagError(f'{bag.path} has no motion that could be written')
    [joint] = [MOTION.codec.joint]  # type: ignore[attr-defined]
    writer = BagWriter(path, version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    empty = np.array([])
    try:
        with writer:
            link = writer.add_connection('/joint_states', _JOINT_STATE, typestore=get_typestore(Stores.ROS2_JAZZY))
            for stamp, angle, rate in zip(motion.stamps_ns.tolist(), motion.angle, motion.rate, strict=True):
                header = new_message('std_msgs/msg/Header', new_time(stamp), '')
                raw = serialise(_JOINT_STATE, header, [joint], np.array([angle]), np.array([rate]), empty)
                writer.write(link, stamp, raw)
            for name, value in described(bag).items():
                writer.set_custom_data(name, value)
    except BaseException:
        shutil.rmtree(path, ignore_errors=True)
        raise
    return int(motion.angle.size)


FORMATS: dict[str, Callable[[Path, tuple[Table, ...], Mapping[str, str]], int]] = {
    'csv': _write_csv,
    'parquet': _write_parquet,
    'netcdf': _write_netcdf,
}
"""Of tables; besides, `JOINT_STATES` is a bag."""
