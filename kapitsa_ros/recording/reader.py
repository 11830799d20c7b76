"""Reading runs back: from any rosbag2 bag with the topics of the rig, whole or not."""

from __future__ import annotations

import math
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kapitsa_ros.analysis.recorded_run import RecordedRun
from kapitsa_ros.network.cdr import stamp_of
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import (
    COMMAND,
    MOTION,
    PIVOT,
    READINGS,
    described_by,
)
from kapitsa_ros.network.run_builder import RunBuilder
from kapitsa_ros.network.settings import parse_settings
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.recording.errors import BagError, printable
from kapitsa_ros.recording.motion import Motion, joined_motion
from kapitsa_ros.recording.recording import Recording
from kapitsa_ros.recording.run_choice import REQUIRED_ROLES, RUN_TOPICS, begun_runs
from kapitsa_ros.recording.stored_run import StoredRun

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from os import PathLike

    import pandas as pd
    import xarray as xr

    from kapitsa_ros.network.run import Run
    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.physics.sampled_motion import SampledMotion


class RunBag(StoredRun):
    """A recorded run: what was commanded and read, and the motion.

    Steps that are damaged or stand twice are left out; `defects` says so, and what is missing.

    Parameters
    ----------
    path
        Folder of the bag, or a storage file of it.
    run
        Number of the run, where the bag holds several; `open_runs` takes such a bag apart.

    Raises
    ------
    BagError
        There is no bag, it lacks topics of the rig, or holds several runs.

    """

    @cached_property
    def run(self) -> Run:
        """The run that the readings and commands in the bag make; steps that are missing `defects` names.

        Raises
        ------
        BagError
            Nothing of a run is there, or a message is not what its topic promises.

        """
        return self.run_before(math.inf)

    def run_before(self, end: float) -> Run:
        """Return the run as it was before a step.

        Raises
        ------
        BagError
            Nothing of a run is there, or a message is not what its topic promises.

        """
        try:
            lacking = [role for role in described_by(REQUIRED_ROLES) if role not in self.settings]
            if lacking:
                raise BagError(f'{self.path} is damaged: the settings of {", ".join(lacking)} are lost')
            builder = RunBuilder(self.number, self.settings)
            present = [topic for topic in RUN_TOPICS if topic.name in self._index.present]
            count = 0
            for step in self._steps([topic.name for topic in present], end=end):
                builder.add(step[COMMAND], {topic: step[topic] for topic in READINGS if topic in step})
                count += 1
        except (WireError, KeyError) as error:
            raise BagError(f'{self.path} is damaged: {error}') from error
        if not count:
            why = f': {printable(self.integrity.defects[0])}' if self.integrity.defects else ''
            raise BagError(f'{self.path} holds no step of a run{why}')
        return builder.build(complete=self.complete and end == math.inf)

    @cached_property
    def settings(self) -> dict[str, dict[str, Any]]:
        """What each role that describes the run has said of itself.

        Raises
        ------
        BagError
            Some of it is no settings.

        """
        found = {}
        for role, text in self.settings_texts.items():
            try:
                found[role] = parse_settings(text)
            except WireError as error:
                raise BagError(f'{self.path} is damaged: the settings of {role}: {error}') from error
        return found

    @cached_property
    def motion(self) -> Motion:
        """The pendulum's motion, and how much of it is missing.

        Raises
        ------
        BagError
            A block is not what its topic promises.

        """
        return self._joined(self._on(MOTION.name))

    @cached_property
    def motion_counts(self) -> tuple[int, int]:
        """Samples of the motion and its gaps: `motion.angle.size` and `motion.gaps`, in little memory.

        Raises
        ------
        BagError
            A block is not what its topic promises.

        """
        samples = gaps = 0
        end = -1
        for piece in self.motion_in_pieces(steps=100):
            samples += piece.stamps_ns.size - (piece.stamps_ns[0] == end)
            gaps += piece.gaps
            end = piece.stamps_ns[-1]
        return int(samples), gaps

    def motion_in_pieces(self, steps: int = 1000) -> Iterator[Motion]:
        """Yield the motion so many steps at a time, for a run that is larger than memory.

        Each begins with the sample at which the one before ended; what is missing counts to the one after it.

        Raises
        ------
        BagError
            A block is not what its topic promises.

        """
        blocks, end_ns = self._on(MOTION.name), None
        while piece := list(islice(blocks, steps)):
            motion = self._joined(piece, end_ns)
            end_ns = int(motion.stamps_ns[-1])
            yield motion

    def _joined(self, blocks: Iterable[tuple[StepId, bytes]], begin_ns: int | None = None) -> Motion:
        decoded = ((step_id.step, stamp_of(raw), MOTION.decode(raw)) for step_id, raw in blocks)
        try:
            return joined_motion(decoded, begin_ns)
        except (WireError, OverflowError) as error:
            raise BagError(f'{self.path} is damaged: {error}') from error

    @property
    def recorded(self) -> RecordedRun:
        """The run together with its motion."""
        seconds = (self.motion.stamps_ns - self.motion.stamps_ns[:1]) / SECOND
        return RecordedRun(
            name=self.name,
            run=self.run,
            time=seconds,
            angle=self.motion.angle,
            asked=self._asked(),
            defects=self.defects,
            unverified=self.integrity.ok is None,
        )

    def _asked(self) -> tuple[tuple[float, float], ...]:
        """Return from which second of the motion on which speed was asked for."""
        found: list[tuple[float, float]] = []
        for start in self.motion.stamps_ns[:1].tolist():
            for _, raw in self._on(COMMAND.name):
                speed = COMMAND.decode(raw).speed
                if not found or speed != found[-1][1]:
                    found.append(((stamp_of(raw) - start) / SECOND, speed))
        return tuple(found)

    def to_pandas(self, *topics: str) -> pd.DataFrame:
        """Return motion, pivot, commands and readings, or some topics; a row for each time that one of them has."""
        from kapitsa_ros.recording.export import frame_of  # noqa: PLC0415  # it reads bags

        return frame_of(self, topics)

    def to_xarray(self, *topics: str) -> xr.Dataset:
        """Return the same by topic, each over a time of its own, with units."""
        from kapitsa_ros.recording.export import dataset_of  # noqa: PLC0415

        return dataset_of(self, topics)

    def motions(self, begin: int, end: int) -> Iterator[tuple[float, SampledMotion, SampledMotion]]:
        """Yield start (s of the run) and motions of pendulum and pivot, from step `begin` to before `end`.

        Steps that lack either motion are left out.

        Raises
        ------
        BagError
            A block is not what its topic promises.

        """
        try:
            for step in self._steps([MOTION.name, PIVOT.name], begin, end):
                yield step.start, step[MOTION], step[PIVOT]
        except WireError as error:
            raise BagError(f'{self.path} is damaged: {error}') from error

    def pivot(self) -> Iterator[tuple[StepId, SampledMotion]]:
        """Yield the pivot's motion step by step."""
        for step_id, raw in self._on(PIVOT.name):
            yield step_id, PIVOT.decode(raw)


def open_runs(path: str | PathLike[str]) -> tuple[RunBag, ...]:
    """Return the runs in a bag: one as a rule, several where a whole session was recorded to it.

    Raises
    ------
    BagError
        There is no bag, or no run of this rig in it.

    """
    recording = Recording(Path(path))
    numbers = begun_runs(recording)
    if len(numbers) < 2:
        return (RunBag(path, recording=recording),)
    return tuple(RunBag(path, number, recording=recording) for number in numbers)


def runs_of(paths: Iterable[Path]) -> list[RunBag]:
    """Return the runs in several bags, in their order; a run that stands in two of them has a defect that says so.

    Raises
    ------
    BagError
        One of them is no bag, or has no run of this rig in it.

    """
    bags = [bag for path in paths for bag in open_runs(path)]
    alike: dict[tuple[int, int], list[RunBag]] = {}
    for bag in bags:
        others = alike.setdefault((bag.number, bag.messages), [])
        same = (other for other in others if other.digest == bag.digest and other.path.resolve() != bag.path.resolve())
        bag.repeats = next((other.path for other in same), None)
        others.append(bag)
    return bags
