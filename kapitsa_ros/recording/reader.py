"""Reading a run back: any rosbag2 bag with the topics of the rig."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rosbags.rosbag2 import Reader

from kapitsa_ros.analysis.recorded_run import RecordedRun
from kapitsa_ros.data_frame import data_frame
from kapitsa_ros.network.cdr import read_step_id, stamp_of
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import (
    COMMAND,
    MOTION,
    PIVOT,
    READINGS,
    RIG_ROLES,
    STROBE_READING,
    described_by,
    writer_of,
)
from kapitsa_ros.network.run_builder import RunBuilder
from kapitsa_ros.network.settings import decode_settings, settings_topic
from kapitsa_ros.network.step import Step
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.writer import FORMAT, FORMAT_KEY

if TYPE_CHECKING:
    from collections.abc import Iterator
    from os import PathLike

    import pandas as pd

    from kapitsa_ros.network.run import Run
    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.physics.sampled_motion import SampledMotion

_RUN_TOPICS = (COMMAND, *READINGS)
"""Those that make a run."""
_REQUIRED = [role for role in RIG_ROLES if not role.optional]


@dataclass(frozen=True, eq=False)
class Motion:
    """A recorded motion as one series; shape (N,) each, SI units."""

    stamps_ns: np.ndarray[Any, np.dtype[np.int64]]
    angle: np.ndarray[Any, np.dtype[np.float64]]
    rate: np.ndarray[Any, np.dtype[np.float64]]
    gaps: int
    """Places where a sample or a step is missing."""
    lost: float
    """Seconds of motion missing there."""

    def to_pandas(self) -> pd.DataFrame:
        """Return a row a sample, times from the first on."""
        seconds = (self.stamps_ns - self.stamps_ns[:1]) / SECOND
        return data_frame({'time_s': seconds, 'angle_rad': self.angle, 'rate_rad_s': self.rate})


class RunBag:
    """A recorded run.

    Parameters
    ----------
    path
        Folder of the bag.

    Raises
    ------
    BagError
        There is no bag, it was never finished, or it lacks topics of the rig.

    """

    def __init__(self, path: str | PathLike[str]) -> None:
        self.path = path = Path(path)
        if not path.is_dir():
            raise BagError(f'{path} is no bag: give the folder of a run')
        if not (path / 'metadata.yaml').is_file():
            kind = 'was never finished' if any(path.glob('*.mcap')) or any(path.glob('*.db3')) else 'is no bag'
            raise BagError(f'{path} {kind}: it has no metadata.yaml')
        try:
            with Reader(path) as reader:
                self.topics = frozenset(connection.topic.removeprefix('/') for connection in reader.connections)
                """Names of those recorded."""
                self.messages = reader.message_count
                self.first_stamp_ns = reader.start_time
                self.last_stamp_ns = reader.end_time - 1
                self.format = _format_of(reader)
                """Version of the bag's format; 0 for bags that state none."""
        except Exception as error:  # rosbags raises whatever the libraries below it do
            raise BagError(f'{path} cannot be read: {error}') from error
        if self.format > FORMAT:
            raise BagError(
                f'{path} has format {self.format}, this version reads up to {FORMAT}: install a newer kapitsa_ros'
            )
        if not self.messages:
            raise BagError(f'{path} is empty: the run was never begun')
        needed = [topic.name for topic in _RUN_TOPICS if not writer_of(topic).optional]
        needed += map(settings_topic, described_by(_REQUIRED))
        missing = [name for name in needed if name not in self.topics]
        if missing:
            raise BagError(f'{path} is no run of this rig: it lacks {", ".join(missing)}')

    def __repr__(self) -> str:
        """Return what it is and where."""
        return f'RunBag({str(self.path)!r}, {self.messages} messages)'

    def raw(self, *names: str) -> Iterator[tuple[str, int, bytes]]:
        """Yield topic, stamp (ns) and bytes of the messages on the named topics, in the order of recording.

        Raises
        ------
        BagError
            The file is damaged.

        """
        try:
            with Reader(self.path) as reader:
                connections = [
                    connection for connection in reader.connections if connection.topic.removeprefix('/') in names
                ]
                # Without a connection rosbags would read them all.
                for connection, stamp, data in reader.messages(connections) if connections else ():
                    yield connection.topic.removeprefix('/'), stamp, bytes(data)
        except Exception as error:  # rosbags raises whatever the libraries below it do
            raise BagError(f'{self.path} is damaged: {error}') from error

    @cached_property
    def settings_texts(self) -> dict[str, str]:
        """JSON text by role."""
        names = {settings_topic(role): role for role in described_by()}
        return {names[topic]: decode_settings(raw) for topic, _, raw in self.raw(*names)}

    @cached_property
    def run(self) -> Run:
        """The run that the readings and commands in the bag make.

        Raises
        ------
        BagError
            Steps are missing or a message is not what its topic promises.

        """
        try:
            settings = {node: json.loads(text) for node, text in self.settings_texts.items()}
            steps = list(self._steps())
            if not steps:
                raise BagError(f'{self.path} holds no step of a run')
            builder = RunBuilder(steps[0].id.run, settings)
            for step in steps:
                if not step.id.end:
                    builder.add(step[COMMAND], {topic: step[topic] for topic in READINGS if topic in step})
        except (WireError, json.JSONDecodeError, KeyError) as error:
            raise BagError(f'{self.path} is damaged: {error}') from error
        return builder.build(complete=steps[-1].id.end)

    @cached_property
    def complete(self) -> bool:
        """Whether the run came to its end."""
        try:
            return any(read_step_id(raw).end for _, _, raw in self.raw(STROBE_READING.name))
        except WireError as error:
            raise BagError(f'{self.path} is damaged: {error}') from error

    @cached_property
    def motion(self) -> Motion:
        """The pendulum's motion, and how much of it is missing.

        Raises
        ------
        BagError
            A block is not what its topic promises.

        """
        stamps, angles, rates = [], [], []
        try:
            for _, _, raw in self.raw(MOTION.name):
                if read_step_id(raw).end:
                    continue
                samples = MOTION.decode(raw)
                times = np.arange(samples.position.size) * round(samples.period * SECOND)
                stamps.append(stamp_of(raw) + times)
                angles.append(samples.position)
                rates.append(samples.rate)
        except WireError as error:
            raise BagError(f'{self.path} is damaged: {error}') from error
        if not stamps:
            empty = np.array([])
            return Motion(empty.astype(np.int64), empty, empty, 0, 0.0)
        joined = np.concatenate(stamps)
        periods = np.diff(joined)
        # Blocks hold both ends, so a block begins at the stamp at which the last one ended.
        fresh = np.concatenate(([True], periods > 0))
        period = np.median(periods[periods > 0])
        gaps = periods[periods > period]
        lost = float((gaps - period).sum()) / SECOND
        return Motion(joined[fresh], np.concatenate(angles)[fresh], np.concatenate(rates)[fresh], gaps.size, lost)

    @property
    def recorded(self) -> RecordedRun:
        """The run together with its motion."""
        seconds = (self.motion.stamps_ns - self.motion.stamps_ns[:1]) / SECOND
        return RecordedRun(name=self.path.name, run=self.run, time=seconds, angle=self.motion.angle)

    def pivot(self) -> Iterator[tuple[StepId, SampledMotion]]:
        """Yield the pivot's motion step by step."""
        for _, _, raw in self.raw(PIVOT.name):
            if not read_step_id(raw).end:
                yield read_step_id(raw), PIVOT.decode(raw)

    def _steps(self) -> Iterator[Step]:
        """Yield the commands and readings step by step; at the end, the readings' end."""
        present = [topic for topic in _RUN_TOPICS if topic.name in self.topics]
        pending: dict[StepId, dict[str, bytes]] = {}
        last: StepId | None = None
        for topic, _, raw in self.raw(*(topic.name for topic in present)):
            step_id = read_step_id(raw)
            messages = pending.setdefault(step_id, {})
            messages[topic] = raw
            # The operator, who ended the run, says nothing at its end.
            if len(messages) == len(present) - step_id.end:
                if last is not None and not step_id.follows(last):
                    raise BagError(f'{self.path}: {step_id} came after {last}')
                last = step_id
                yield Step(step_id, pending.pop(step_id))


def _format_of(reader: Reader) -> int:
    """Return the format that a bag states, 0 where it states none; a bag file without its folder cannot."""
    custom = getattr(reader.storage.metadata, 'custom', None) or {}
    text = custom.get(FORMAT_KEY, '0')
    return int(text) if text.isdecimal() else 0
