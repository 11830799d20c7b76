"""A recorded run as tables for other tools: units in the names of the columns, settings in the file's metadata."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros.data_frame import data_frame, dataset
from kapitsa_ros.errors import OPTION
from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.registry import COMMAND, MOTION, PIVOT, STOPWATCH_READING, STROBE_READING
from kapitsa_ros.network.step_clock import SECOND, seconds_of_run
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.recording.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import pandas as pd
    import xarray as xr
    from numpy.typing import NDArray

    from kapitsa_ros.recording.reader import RunBag

    Columns = dict[str, NDArray[Any]]

_UNITS = {'_rad': 'rad', '_rad_s': 'rad/s', '_m': 'm', '_m_s': 'm/s', '_m_s2': 'm/s^2', '_s': 's'}


@dataclass(frozen=True, kw_only=True, eq=False)
class Table:
    """Values of one topic, by time."""

    topic: str
    columns: Mapping[str, NDArray[Any]]
    """By name, the unit at its end; shape (N,) each, `time_s` first."""


def tables(bag: RunBag, topics: tuple[str, ...] = ()) -> tuple[Table, ...]:
    """Return the topics of a run as tables.

    Parameters
    ----------
    bag
        The run.
    topics
        Names; all that can be had where none is given.

    Raises
    ------
    BagError
        There is no such topic, or a message is not what its topic promises.

    """
    names = [topic.removeprefix('/') for topic in topics] or [name for name in _COLUMNS if name in bag.topics]
    for name in names:
        if name not in _COLUMNS or name not in bag.topics:
            raise BagError(
                f'{OPTION}: give one of {", ".join(each for each in _COLUMNS if each in bag.topics)}',
                option='topic',
                value=name,
            )
    return tuple(Table(topic=name, columns=_COLUMNS[name](bag)) for name in names)


def joined(found: tuple[Table, ...]) -> Columns:
    """Return tables as one, a row for each time that one of them has; nan and empty texts stand for no value."""
    stamps = [np.round(table.columns['time_s'] * SECOND).astype(np.int64) for table in found]
    times = np.unique(np.concatenate(stamps))
    columns: Columns = {'time_s': times / SECOND}
    for table, stamp in zip(found, stamps, strict=True):
        rows = np.searchsorted(times, stamp)
        for name, values in table.columns.items():
            if name != 'time_s':
                columns[name] = np.full(times.size, '' if values.dtype.kind == 'U' else np.nan, values.dtype)
                columns[name][rows] = values
    return columns


def frame_of(bag: RunBag, topics: tuple[str, ...] = ()) -> pd.DataFrame:
    """Return topics of a run as one data frame; see `tables` and `joined`."""
    frame = data_frame(joined(tables(bag, topics)))
    frame.attrs |= described(bag)
    return frame


def dataset_of(bag: RunBag, topics: tuple[str, ...] = ()) -> xr.Dataset:
    """Return topics of a run as a dataset, each with a dimension `time_TOPIC` of its own; see `tables`."""
    variables = {}
    for table in tables(bag, topics):
        dimension = time_of(table)
        for name, values in table.columns.items():
            variables[dimension if name == 'time_s' else name] = (dimension, values, {'units': unit_of(name)})
    return dataset(variables, described(bag))


def time_of(table: Table) -> str:
    """Return the name of a table's dimension, where each has its own."""
    return f'time_{table.topic.replace("/", "_")}'


def unit_of(column: str) -> str:
    """Return the unit that a column's name ends with; 1 for a number."""
    ends = [end for end in _UNITS if column.endswith(end)]
    return _UNITS[max(ends, key=len)] if ends else '1'


def described(bag: RunBag) -> dict[str, str]:
    """Return what a file of exported values says of its run, as texts by name."""
    return {
        'bag': bag.name,
        'run': str(bag.number),
        'digest': bag.digest,
        'verified': 'unknown' if bag.integrity.ok is None else str(bag.integrity.ok).lower(),
        'complete': str(bag.complete).lower(),
        'defects': json.dumps(list(bag.defects)),
        'settings': json.dumps(bag.settings),
    }


def _motion(bag: RunBag) -> Columns:
    motion = bag.motion
    time = (motion.stamps_ns - _begin(bag)) / SECOND
    return {'time_s': time, 'pendulum_angle_rad': motion.angle, 'pendulum_rate_rad_s': motion.rate}


def _pivot(bag: RunBag) -> Columns:
    times, columns = [], []
    for _, stamp, raw in bag.raw(PIVOT.name):
        if not read_step_id(raw).end:
            block = PIVOT.decode(raw)
            times.append(stamp - _begin(bag) + np.arange(block.position.size - 1) * round(block.period * SECOND))
            columns.append(np.stack((block.position, block.rate, block.acceleration))[:, :-1])  # the next begins there
    joined = np.concatenate(columns, axis=1) if columns else np.zeros((3, 0))
    seconds = np.concatenate(times) / SECOND if times else np.zeros(0)
    names = ('pivot_m', 'pivot_rate_m_s', 'pivot_acceleration_m_s2')
    return {'time_s': seconds, **dict(zip(names, joined, strict=True))}


def _commands(bag: RunBag) -> Columns:
    rows = []
    for _, stamp, raw in bag.raw(COMMAND.name):
        command = COMMAND.decode(raw)
        if not command.end:
            held = np.nan if command.hold is None else command.hold
            rows.append(((stamp - _begin(bag)) / SECOND, command.speed, held))
    time, speed, hold = np.array(rows, np.float64).reshape(-1, 3).T
    return {'time_s': time, 'command_speed_rad_s': speed, 'command_hold_rad': hold}


def _strobe(bag: RunBag) -> Columns:
    readings = bag.run.readings.get('strobe', ())
    return {
        'time_s': np.array([each.time for each in readings], np.float64),
        'strobe_speed_rad_s': np.array([each.speed for each in readings], np.float64),
    }


def _stopwatch(bag: RunBag) -> Columns:
    readings = bag.run.readings.get('stopwatch', ())
    return {
        'time_s': np.array([each.pressed_at for each in readings], np.float64),
        'stopwatch_displayed_s': np.array([each.displayed for each in readings], np.float64),
        'stopwatch_swings': np.array([each.swings for each in readings], np.float64),
        'stopwatch_kind': np.array([each.kind for each in readings], np.str_),
    }


def _begin(bag: RunBag) -> int:
    """Return the stamp at which the run begins, whether or not its first step is there."""
    number = StepId(bag.number, 0)
    return bag.first_stamp_ns - round(seconds_of_run(bag.first_stamp_ns, number) * SECOND)


_COLUMNS: dict[str, Callable[[RunBag], Columns]] = {
    MOTION.name: _motion,
    PIVOT.name: _pivot,
    COMMAND.name: _commands,
    STROBE_READING.name: _strobe,
    STOPWATCH_READING.name: _stopwatch,
}
"""By the name of a topic."""
