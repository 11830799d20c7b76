"""What stands in a bag, whoever recorded it and whatever happened to it: its runs, and what is missing or damaged."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import RECORDED, described_by
from kapitsa_ros.network.settings import SETTINGS_TYPE, decode_settings, settings_topic
from kapitsa_ros.network.step_id import ends_session
from kapitsa_ros.recording.digest import DIGEST_TOPIC, MOST_STEPS, message_digest, parse_group
from kapitsa_ros.recording.errors import BagError, printable
from kapitsa_ros.recording.message_table import MessageTable
from kapitsa_ros.recording.run_index import RunIndex
from kapitsa_ros.recording.storage.bag_files import METADATA, BagFiles
from kapitsa_ros.recording.storage.promise import Promise, parse_promise

if TYPE_CHECKING:
    from pathlib import Path

    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.recording.storage.stored_message import StoredMessage

_TYPES = {topic.name: topic.type for topic in RECORDED} | {
    settings_topic(role): SETTINGS_TYPE for role in described_by()
}
_ROLES = {settings_topic(role): role for role in described_by()}
_MOST_RUNS = 10**6
"""Larger numbers are damage: simulated time would not hold them."""
_FEW = 5
"""Defects of one file that are told one by one."""


@dataclass(frozen=True, kw_only=True)
class LatchedSettings:
    """Settings of a role as they stand in a bag."""

    role: str
    text: str
    digest: str
    place: int
    """How many numbered messages stand before it."""


class Recording:
    """All that stands in a bag.

    Parameters
    ----------
    path
        Its folder, or a storage file.

    Raises
    ------
    BagError
        There is no bag, or nothing of it can be read.

    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._files = BagFiles(path)
        self.table = MessageTable()
        self.topics: dict[str, str] = {}
        """Type by name, of all that were recorded."""
        self.wrong_types: dict[str, str] = {}
        """Of topics of the rig that have messages of another type: by name, a sentence."""
        self.settings: list[LatchedSettings] = []
        self.runs: dict[int, RunIndex] = {}
        self.damages: list[str] = []
        """What is there and cannot be read, a sentence each."""
        self.defects: list[str] = []
        """That, and what is missing."""
        self._counts: Counter[str] = Counter()
        self._left_out: Counter[str] = Counter()
        self._scan()
        self.namespaces = self._namespaces()
        """In which the rigs ran whose topics were recorded, where none ran outside of all."""
        if len(self.namespaces) == 1:
            # Once more, now that it is known; what no rig in a namespace has made is read once.
            self._files = BagFiles(path)
            self.topics.clear()
            self._counts.clear()
            self._scan(f'{self.namespaces[0]}/')
        self.promise = self._promise()
        self._collect_defects()

    @property
    def storage(self) -> str:
        """`mcap` or `sqlite3`."""
        return self._files.files[0].storage

    @property
    def foreign_topics(self) -> frozenset[str]:
        """Names of topics that are not of the rig."""
        return frozenset(self.topics) - {*_TYPES, DIGEST_TOPIC}

    @property
    def has_metadata(self) -> bool:
        """Whether there is a `metadata.yaml` that can be used."""
        return self._files.promise is not None

    @property
    def finished(self) -> bool:
        """Whether the recorder has closed the bag."""
        return self.has_metadata or all(file.finished for file in self._files.files)

    def close(self) -> None:
        """Leave the files; whoever reads again opens them again."""
        self._files.close()

    def read(self, message: int) -> bytes:
        """Return the bytes of a message.

        Raises
        ------
        BagError
            They are no longer those that were there when the bag was opened.

        """
        file, block, at = self.table.place(message)
        try:
            raw = self._files.files[file].read(block, at)
        except (ValueError, TypeError) as error:
            raise BagError(f'{self.path} was changed while it was read: {error}') from error
        if message_digest(raw) != self.table.digest(message):
            raise BagError(f'{self.path} was changed while it was read')
        return raw

    def _scan(self, prefix: str = '') -> None:
        """Take in all messages, on topics whose names begin so as if they did not."""
        try:
            for number, file in enumerate(self._files.files):
                for message in file.scan():
                    self._counts[message.topic] += 1
                    self._take(number, message._replace(topic=message.topic.removeprefix(prefix)))
        finally:
            self.close()

    def _namespaces(self) -> list[str]:
        if not self.topics.keys().isdisjoint(_TYPES):
            return []
        ends = [f'/{name}' for name in _TYPES]
        return sorted({name.removesuffix(end) for name in self.topics for end in ends if name.endswith(end)})

    def _take(self, file: int, message: StoredMessage) -> None:
        topic = message.topic
        self.topics.setdefault(topic, message.type)
        if topic == DIGEST_TOPIC:
            group = parse_group(message.data)
            if group is not None:
                run = self.runs.setdefault(group.run, RunIndex(group.run, len(self.table)))
                run.groups.append(group)
        elif topic not in _TYPES:
            return
        elif message.type != _TYPES[topic]:
            self.wrong_types[topic] = f'{topic} is of type {message.type or "unknown"}, not {_TYPES[topic]}'
            self._left_out[self.wrong_types[topic]] += 1
        elif topic in _ROLES:
            self._take_settings(message)
        else:
            self._take_step(file, message)

    def _take_settings(self, message: StoredMessage) -> None:
        try:
            text = decode_settings(message.data)
        except WireError as error:
            self._left_out[f'{message.topic} is damaged: {error}'] += 1
            return
        digest = message_digest(message.data).hex()
        role = _ROLES[message.topic]
        self.settings.append(LatchedSettings(role=role, text=text, digest=digest, place=len(self.table)))

    def _take_step(self, file: int, message: StoredMessage) -> None:
        step_id: StepId | None
        try:
            step_id = read_step_id(message.data)
        except WireError:
            step_id = None
        if step_id is None or step_id.run > _MOST_RUNS or step_id.step > MOST_STEPS:
            self._left_out[f'{message.topic} carries no number of a step'] += 1
            return
        if ends_session(step_id):
            return
        run = self.runs.get(step_id.run)
        if run is None:
            run = self.runs[step_id.run] = RunIndex(step_id.run, len(self.table))
        digest = message_digest(message.data)
        there = run.find(message.topic, step_id)
        if there is None:
            run.put(message.topic, step_id, self.table.add(file, message.block, message.at, digest))
        elif self.table.digest(there) == digest:
            run.repeated += 1
        else:
            run.conflicts.add((message.topic, step_id.step))

    def _promise(self) -> Promise:
        if self._files.promise is not None:
            return self._files.promise
        for file in self._files.files:
            if file.metadata is not None and len(self._files.files) == 1:
                try:
                    return parse_promise(file.metadata)
                except BagError as error:
                    self.damages.append(f'the metadata in {file.path.name} cannot be used: {error}')
        return Promise()

    def _collect_defects(self) -> None:
        self.damages += self._files.defects
        for file in self._files.files:
            self.damages += _told(file.defects, file.path.name)
        self.damages += [f'{why}: {count} messages left out' for why, count in self._left_out.items()]
        self.damages = list(map(printable, self.damages))
        self.defects += self.damages
        for file in self._files.files:
            if file.cut_off is not None:
                self.defects.append(f'{file.path.name}: {file.cut_off}')
        if not self.finished:
            self.defects.append(f'it has no {METADATA}: it was never finished, or is part of a bag')
        short = {
            topic: (self._counts[topic], count)
            for topic, count in self.promise.counts.items()
            if self._counts[topic] < count
        }
        if short:
            there, counted = (sum(values) for values in zip(*short.values(), strict=True))
            self.defects.append(
                f'{METADATA} counts {counted} messages on {", ".join(sorted(short))}, {there} can be read: '
                'what was not written cannot be had; `kapitsa bag recover` makes a bag of what is there'
            )


def _told(defects: list[str], file: str) -> list[str]:
    more = len(defects) - _FEW
    return [*defects[:_FEW], *([f'{file}: and {more} places more'] if more > 0 else [])]
