"""The messages of one run in a bag, whole or not: which there are, what is wrong with them, and their order."""

from __future__ import annotations

import math
from functools import cached_property
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from kapitsa_ros.file_name_text import shown_name
from kapitsa_ros.network.cdr import read_step_id, stamp_of
from kapitsa_ros.network.registry import COMMAND, MOTION, PIVOT, RECORDED, REPLAYED, described_by
from kapitsa_ros.network.settings import encode_settings, settings_topic
from kapitsa_ros.network.step import Step
from kapitsa_ros.network.step_clock import DAY
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.recording.errors import BagError, printable
from kapitsa_ros.recording.integrity import leave_out_damaged, run_digest
from kapitsa_ros.recording.naming import name_of
from kapitsa_ros.recording.processor import PROCESSOR_KEY, parse_processor
from kapitsa_ros.recording.recording import Recording
from kapitsa_ros.recording.run_choice import begun_runs, chosen_run, format_of
from kapitsa_ros.recording.run_index import steps_text

if TYPE_CHECKING:
    from collections.abc import Iterator
    from os import PathLike

_STAMPED = (PIVOT.name, MOTION.name, COMMAND.name)
"""Topics whose stamp is that of their step."""
_NAMES = [topic.name for topic in REPLAYED]


class StoredRun:
    """The messages of one run in a bag.

    Parameters
    ----------
    path
        Folder of the bag, or a storage file of it.
    run
        Number of the run, where the bag holds several.

    Raises
    ------
    BagError
        There is no bag, it lacks topics of the rig, or holds several runs.

    """

    def __init__(
        self, path: str | PathLike[str], run: int | None = None, *, recording: Recording | None = None
    ) -> None:
        self.path = Path(path)
        self._recording = recording or Recording(self.path)
        self.format = format_of(self._recording)
        """Version of the bag's format; 0 for bags that state none."""
        self.topics = frozenset(self._recording.topics)
        """Names of those recorded."""
        self._index = chosen_run(self.path, self._recording, run)
        self.several = len(begun_runs(self._recording)) > 1
        """Whether the bag holds other runs too."""
        promised = {} if self.several else self._recording.promise.custom
        self.integrity = leave_out_damaged(self._index, self._recording.table, promised)
        """What the digests say."""
        self.repeats: Path | None = None
        """Another bag given beside this one that holds the same run; `runs_of` looks for it."""

    def __repr__(self) -> str:
        """Return what it is and where."""
        which = f', run={self.number}' if self.several else ''
        return f'{type(self).__name__}({str(self.path)!r}{which}, {self.messages} messages)'

    @property
    def number(self) -> int:
        """Of the run."""
        return self._index.number

    @property
    def name(self) -> str:
        """Of the run, as tables show it."""
        folder = shown_name(name_of(self.path))
        return f'{folder} run {self.number}' if self.several else folder

    @cached_property
    def messages(self) -> int:
        """How many of the run can be read, its settings included."""
        return self._index.messages + len(self.settings_texts)

    @cached_property
    def digest(self) -> str:
        """SHA-256 over the run's messages, as far as they are there; equal runs have equal ones."""
        return run_digest(self._index, self._recording.table)

    @property
    def absent(self) -> tuple[str, ...]:
        """Names of the topics of a rig on which the bag has no message of the run, though others may have."""
        return tuple(self._index.absent)

    @property
    def processor(self) -> tuple[str, ...] | None:
        """Architecture and extensions of the processor that it was recorded on; None: the bag does not say."""
        return parse_processor(self._recording.promise.custom.get(PROCESSOR_KEY))

    @property
    def steps(self) -> int:
        """How many steps have a message."""
        return sum(not step_id.end for step_id in self._index.ids(_NAMES))

    @property
    def finished(self) -> bool:
        """Whether the recorder has closed the bag."""
        return self._recording.finished

    @property
    def is_whole(self) -> bool:
        """Whether the bag was closed, has its metadata, and nothing of it is damaged."""
        return self.finished and self._recording.has_metadata and not self.damages

    @property
    def storage(self) -> str:
        """`mcap` or `sqlite3`."""
        return self._recording.storage

    @property
    def foreign_topics(self) -> frozenset[str]:
        """Names of topics that are not of the rig."""
        return self._recording.foreign_topics

    @property
    def damages(self) -> list[str]:
        """Of the defects, those by which something is there that cannot be read, or was changed."""
        return [*self._recording.damages, *self.integrity.defects]

    @cached_property
    def defects(self) -> tuple[str, ...]:
        """What is missing or damaged, a sentence each; empty for a bag that is as it should be."""
        found = [*self._recording.defects, *self.integrity.defects, *self._index.defects()]
        if self.repeats is not None:
            found.append(
                f'the run is that of {self.repeats}, given once more: in an analysis it counts each time, '
                'which makes the interval too narrow'
            )
        return tuple(map(printable, found))

    def raw(self, *names: str, begin: int = 0, end: float = math.inf) -> Iterator[tuple[str, int, bytes]]:
        """Yield topic, stamp of the step (ns) and bytes of the messages on the named topics, in the order of steps.

        Parameters
        ----------
        *names
            Of the topics.
        begin, end
            Steps that are wanted, the latter not included.

        Raises
        ------
        BagError
            What is there is not what was recorded, or the file was changed meanwhile.

        """
        self.refuse_changed()
        try:
            for role, text in self.settings_texts.items():
                if settings_topic(role) in names:
                    yield settings_topic(role), self.first_stamp_ns, encode_settings(text)
            topics = [topic.name for topic in RECORDED if topic.name in names]
            for step_id in self._index.ids(topics):
                if not begin <= step_id.step < end:
                    continue
                stamp = self._stamp(step_id)
                for topic in topics:
                    message = self._index.find(topic, step_id)
                    if message is not None:
                        yield topic, stamp, self._recording.read(message)
        finally:
            self._recording.close()

    def messages_by_step(self, *names: str) -> Iterator[tuple[StepId, str, bytes]]:
        """Yield step, topic and bytes of the messages on the named topics, in the order of the steps; see `raw`."""
        for topic, _, raw in self.raw(*names):
            yield read_step_id(raw), topic, raw

    @cached_property
    def settings_texts(self) -> dict[str, str]:
        """JSON text by role: of the same role several times, that which was latched when the run began."""
        found: dict[str, str] = {}
        expected = self._index.groups[-1].settings if self._index.groups else {}
        later: dict[str, str] = {}
        for each in self._recording.settings:
            if each.role in expected and each.digest != expected[each.role]:
                continue
            if each.place <= self._index.begins:
                found[each.role] = each.text
            else:
                later.setdefault(each.role, each.text)
        return {role: found.get(role, later.get(role, '')) for role in described_by() if role in found or role in later}

    @cached_property
    def complete(self) -> bool:
        """Whether the run came to its end."""
        return self._index.end is not None

    def refuse_gaps(self) -> None:
        """Check that every step is there, without which the nodes of a graph wait for ever.

        Raises
        ------
        BagError
            One is missing, or nothing may be read.

        """
        self.refuse_changed()
        lost = {step for topic in self._index.present for step in self._index.missing(topic)}
        if lost:
            raise BagError(
                f'{self.path} lacks {steps_text(sorted(lost))} of run {self.number}: a graph needs every step; '
                'analyse the bag instead'
            )

    def refuse_changed(self) -> None:
        """Check that what can be read was recorded so.

        Raises
        ------
        BagError
            It was not.

        """
        if self.integrity.refusal is not None:
            raise BagError(f'{self.path}: {self.integrity.refusal}')

    @cached_property
    def first_stamp_ns(self) -> int:
        """Simulated time of the first step that is there."""
        return self._stamp(next(self._index.ids(_NAMES), StepId(self.number, 0)))

    @cached_property
    def last_stamp_ns(self) -> int:
        """Simulated time of the last one, or of the end."""
        *_, last = self._index.ids(_NAMES) if self._index.present else [StepId(self.number, 0)]
        return self._stamp(last)

    def _stamp(self, step_id: StepId) -> int:
        """Return the simulated time of a step: of the topics at hand, that of a leading one."""
        for topic in _STAMPED:
            message = self._index.find(topic, step_id)
            if message is not None:
                return stamp_of(self._recording.read(message))
        return step_id.run * DAY

    def _on(self, topic: str) -> Iterator[tuple[StepId, bytes]]:
        """Yield number and bytes of the messages on a topic, the end left out."""
        for _, _, raw in self.raw(topic):
            step_id = read_step_id(raw)
            if not step_id.end:
                yield step_id, raw

    def _steps(self, topics: list[str], begin: int = 0, end: float = math.inf) -> Iterator[Step]:
        """Yield the steps that have a message on all of the topics, from `begin` to before `end`."""
        found = self.raw(*topics, begin=begin, end=end)
        for step_id, messages in groupby(found, key=lambda message: read_step_id(message[2])):
            raw = {topic: data for topic, _, data in messages}
            if len(raw) == len(topics) and not step_id.end:
                yield Step(step_id, raw)
